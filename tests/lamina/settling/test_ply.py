# SPDX-License-Identifier: GPL-3.0-or-later
"""PLY files of every kind, and damaged ones."""

import gzip
import struct

import numpy as np
import pytest

from lamina import ply
from lamina.common.errors import MeshFileError

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, -2.25]], float)
TRIANGLES = [[0, 1, 2], [0, 2, 3]]


def header(form, vertex="property float x\nproperty float y\nproperty float z", vertices=4,
           face="property list uchar int vertex_indices", faces=2):
    return (f"ply\nformat {form} 1.0\ncomment by hand\nelement vertex {vertices}\n{vertex}\n"
            f"element face {faces}\n{face}\nend_header\n").encode()


def write(tmp_path, data, name="mesh.ply"):
    path = tmp_path / name
    path.write_bytes(data)
    return path


def binary(order, faces=TRIANGLES):
    body = b"".join(struct.pack(f"{order}3f", *v) for v in VERTICES)
    return body + b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)


def ascii_body(faces=TRIANGLES):
    rows = [*VERTICES.tolist(), *([len(f), *f] for f in faces)]
    return "".join(" ".join(map(str, row)) + "\n" for row in rows).encode()


FILES = {
    "ASCII": header("ascii") + ascii_body(),
    "little": header("binary_little_endian") + binary("<"),
    "big": header("binary_big_endian") + binary(">"),
    "CR": (header("ascii") + ascii_body()).replace(b"\n", b"\r"),
    "CR, binary": header("binary_little_endian").replace(b"\n", b"\r") + binary("<"),
    "CRLF, binary": header("binary_big_endian").replace(b"\n", b"\r\n") + binary(">"),
    "indices": header("ascii", face="property list uchar int indices") + ascii_body(),
    "a word in a comment": header("ascii").replace(b"by hand", b"end_header follows") + ascii_body(),
    "a comment of that word": header("binary_big_endian").replace(b"by hand", b"end_header") + binary(">"),
    "nothing, many times": header("ascii").replace(b"element vertex", b"element nothing 1000000000\nelement vertex")
    + ascii_body(),
    "CRLF": (header("ascii") + ascii_body()).replace(b"\n", b"\r\n"),
    "quad": header("ascii", faces=1) + ascii_body([[0, 1, 2, 3]]),
    "binary quad": header("binary_big_endian", faces=1) + binary(">", [[0, 1, 2, 3]]),
    "mixed with lines": header("ascii", faces=3) + ascii_body([[0, 1, 2], [1, 2], [0, 2, 3]]),
    "binary mixed": header("binary_little_endian", faces=3) + binary("<", [[0, 1, 2], [1, 2], [0, 2, 3]]),
    "gzip": gzip.compress(header("ascii") + ascii_body()),
}


@pytest.mark.parametrize("name", FILES)
def test_every_kind_is_the_same_mesh(name, tmp_path):
    mesh = ply.load(write(tmp_path, FILES[name]))
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    assert mesh.triangles.tolist() == TRIANGLES


def test_other_properties_and_elements_are_passed_over(tmp_path):
    vertex = "property double y\nproperty uchar red\nproperty double x\nproperty double z"
    face = "property uchar flag\nproperty list uint uint vertex_index\nproperty list uchar float texcoord"
    more = b"element strips 1\nproperty list int int row\nend_header\n"
    head = header("binary_little_endian", vertex, face=face).replace(b"end_header\n", more)
    body = b"".join(struct.pack("<dBdd", y, 7, x, z) for x, y, z in VERTICES)
    body += b"".join(struct.pack("<BI3IB6f", 1, 3, *f, 6, *range(6)) for f in TRIANGLES)
    mesh = ply.load(write(tmp_path, head + body + struct.pack("<i2i", 2, 0, 1)))
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    assert mesh.triangles.tolist() == TRIANGLES


def test_points_alone_make_no_triangles(tmp_path):
    mesh = ply.load(write(tmp_path, header("ascii", faces=0) + ascii_body([])))
    assert mesh.triangles.shape == (0, 3)


PACKED = gzip.compress(header("ascii") + ascii_body(), mtime=0)
BAD = {
    "foreign": (b"solid cube", "is not a PLY file"),
    "empty": (b"", "is not a PLY file"),
    "short ASCII": (header("ascii") + ascii_body()[:-8], "ends too early"),
    "short binary": (header("binary_little_endian") + binary("<")[:-1], "ends too early"),
    "words": (header("ascii") + b"0 0 zero", "not a number"),
    "index": (header("ascii", faces=1) + ascii_body([[0, 1, 4]]), r"index outside \[0, 3\]"),
    "negative": (header("ascii", faces=1) + ascii_body([[0, 1, -1]]), "index outside"),
    "no z": (header("ascii", "property float x\nproperty float y") + b"0 0", "has no number z"),
    "no faces list": (header("ascii", face="property int area") + ascii_body(), "has no list vertex_indices"),
    "header": (header("ascii").replace(b"comment", b"remark"), "is not understood"),
    "huge": (header("ascii", vertices=10**15), "must have at most 1073741824"),
    "format": (header("ascii").replace(b"format ascii 1.0\n", b""), "has no format line"),
    "gzip": (gzip.compress(header("ascii") + ascii_body())[:-20], "damaged gzip"),
    "a changed byte of gzip": (PACKED[:30] + bytes([PACKED[30] ^ 255]) + PACKED[31:], "damaged gzip"),
    "a number of gzip's": (PACKED[:-8] + b"12345678", "damaged gzip"),
    "faces of nothing": (header("ascii", face="comment none", faces=10**9) + ascii_body(), "has no list"),
    "twice": (header("ascii", face="property list uchar int vertex_indices\nelement vertex 0"), "two elements 'vert"),
    "no end": (header("ascii").replace(b"end_header", b"comment"), "not a PLY file"),
    "a count in other digits": (header("ascii").replace(b"element vertex 4", "element vertex \u0664".encode()),
                                "not understood"),
    "no vertices": (b"ply\nformat ascii 1.0\nend_header\n", "has no vertices"),
}


@pytest.mark.parametrize("name", BAD)
def test_damaged_files_get_one_sentence(name, tmp_path):
    data, words = BAD[name]
    path = write(tmp_path, data)
    with pytest.raises(MeshFileError, match=words) as caught:
        ply.load(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)
