# SPDX-License-Identifier: GPL-3.0-or-later
"""Used by all packages of the add-on: access to `lamina`, preferences, messages to the user, worker
threads."""
