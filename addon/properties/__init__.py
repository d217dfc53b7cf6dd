# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties that materials and objects store in the .blend."""
