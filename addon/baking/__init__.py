# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes: blocking, in a worker thread, and by themselves while the user edits."""
