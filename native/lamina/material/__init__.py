# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stack is made of: media, phase functions, boundaries, bases, metals by name, the library of presets."""
