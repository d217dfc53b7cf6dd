# SPDX-License-Identifier: GPL-3.0-or-later
"""Because of this file pytest adds this folder to the path: all tests of the package use the helpers here."""
