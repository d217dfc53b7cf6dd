# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a sculpture of the demo scenes as a packed PLY file, in mm, the same bytes each time.

    PYTHONPATH=tools python -m sculpting dragon demo_scenes/dragon/dragon.ply.gz
"""

import argparse
import gzip
from pathlib import Path

import numpy as np

from . import cup, dragon

SCULPTURES = {"cup": cup.build, "dragon": dragon.build}
LEVELS = 2**17  # steps of coordinates in the longest side: rounded coordinates need half the space
HEADER = """ply
format binary_little_endian 1.0
comment CC0-1.0
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""


def packed(vertices, quads, triangles):
    """The bytes of the file. vertices: (n, 3); quads: (m, 4); triangles: (k, 3)."""
    header = HEADER.format(vertices=len(vertices), faces=len(quads) + len(triangles))
    step = 2.0 ** np.ceil(np.log2(np.ptp(vertices, axis=0).max())) / LEVELS
    points = (np.rint(vertices / step) * step).astype("<f4")
    faces = (_records(each) for each in (quads, triangles))
    return gzip.compress(b"".join([header.encode(), points.tobytes(), *faces]), 9, mtime=0)


def _records(faces):
    """A list of PLY for each row of `faces`."""
    records = np.empty(len(faces), [("count", "u1"), ("corners", "<i4", faces.shape[1])])
    records["count"], records["corners"] = faces.shape[1], faces
    return records.tobytes()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sculpture", choices=SCULPTURES)
    parser.add_argument("file", type=Path)
    chosen = parser.parse_args()
    chosen.file.write_bytes(packed(*SCULPTURES[chosen.sculpture]()))
