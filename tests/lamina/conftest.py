# SPDX-License-Identifier: GPL-3.0-or-later
"""Pytest puts this folder on the path because of this file: the helpers here serve the tests of all rooms."""
