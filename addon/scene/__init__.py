# SPDX-License-Identifier: GPL-3.0-or-later
"""Work on many objects and their materials at once."""
