# SPDX-License-Identifier: GPL-3.0-or-later
"""The way back from measurements: parameters of a stack, fitted to what was measured. Does not know tables."""
