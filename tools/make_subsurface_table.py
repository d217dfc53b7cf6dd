#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the table of the response of Cycles' random walk in a half-space: native/lamina/subsurface/response.npz.

Takes about ten minutes on one core. Run this script again if Cycles' walk or the method changes."""

from pathlib import Path

import numpy as np

from lamina.common.archive import save_archive
from lamina.subsurface.node_response import G_NODES, later_escape, response

TABLE = Path(__file__).resolve().parents[1] / "native/lamina/subsurface/response.npz"


def main():
    later = later_escape()
    table = []
    for g in G_NODES:
        table.append(response(float(g), later))
        print(f"g = {g:.4f} of {G_NODES[-1]:g}", flush=True)
    header = {"contents": "exit albedo and mean exit distance (transport mean free paths) of Cycles' random walk in a "
                          "half-space, with its limit of 256 flights and without", "axes": ["g", "quantity", "mu", "u"]}
    save_archive(TABLE, header, response=np.array(table, np.float32))


if __name__ == "__main__":
    main()
