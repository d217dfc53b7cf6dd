# SPDX-License-Identifier: GPL-3.0-or-later
"""What every room uses: errors, checked arguments, progress, files that appear whole or not at all."""
