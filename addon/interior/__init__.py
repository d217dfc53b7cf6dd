# SPDX-License-Identifier: GPL-3.0-or-later
"""What is inside of Blender objects."""
