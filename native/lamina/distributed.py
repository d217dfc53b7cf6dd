# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work on the machines of a Dask cluster, with the bytes of one process: pip install distributed. In the place of
the client, any executor of concurrent.futures will do."""

from .cluster.dust import settle_each
from .cluster.estimates import bakes, estimate, estimate_searchlight, light_in_mesh, walk_in_mesh
from .cluster.workers import spread

__all__ = ["bakes", "estimate", "estimate_searchlight", "light_in_mesh", "settle_each", "spread", "walk_in_mesh"]
