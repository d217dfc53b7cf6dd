# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's own name, under which Blender keeps its preferences and folders."""

NAME = __package__.rpartition(".")[0]  # such as bl_ext.user_default.lamina
