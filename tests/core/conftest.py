# SPDX-License-Identifier: GPL-3.0-or-later
"""Because of this file pytest adds this folder to the path: the tests in all rooms use the helpers here."""
