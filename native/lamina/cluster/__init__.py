# SPDX-License-Identifier: GPL-3.0-or-later
"""Work on several machines: the code of lamina.distributed."""
