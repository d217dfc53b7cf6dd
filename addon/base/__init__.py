# SPDX-License-Identifier: GPL-3.0-or-later
"""Used by every room: access to `lamina`, preferences, sentences for the user, worker threads."""
