# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties to stack JSON and back, and what `lamina` says of that JSON."""
