# SPDX-License-Identifier: GPL-3.0-or-later
"""Common to all packages: errors, checked arguments, progress, files that are written completely or not at all."""
