# SPDX-License-Identifier: GPL-3.0-or-later
"""The lookup table: its header, its files, and its forms for other readers."""
