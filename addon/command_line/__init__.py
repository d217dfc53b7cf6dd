# SPDX-License-Identifier: GPL-3.0-or-later
"""The batch: blender -b FILE.blend --command lamina."""
