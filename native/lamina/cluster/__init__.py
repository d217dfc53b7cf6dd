# SPDX-License-Identifier: GPL-3.0-or-later
"""Work on several machines, by the parts of the shard contract: the parts of lamina.distributed."""
