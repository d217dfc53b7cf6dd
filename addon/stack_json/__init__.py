# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of properties to stack JSON and back, and checks of that JSON by `lamina`."""
