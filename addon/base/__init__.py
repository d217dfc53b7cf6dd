# SPDX-License-Identifier: GPL-3.0-or-later
"""What every room uses: the door to `lamina`, preferences, sentences for the user, worker threads."""
