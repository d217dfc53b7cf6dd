# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes: blocking, in a worker thread, and live while the user edits."""
