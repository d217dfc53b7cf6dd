# SPDX-License-Identifier: GPL-3.0-or-later
"""For renderers: directions of light drawn for a view, tables, and a plugin for Mitsuba 3."""
