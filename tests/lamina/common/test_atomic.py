# SPDX-License-Identifier: GPL-3.0-or-later
"""Saves replace ordinary files alone, completely or not at all. No test touches a device."""

import os
import socket
import subprocess
import sys
import time

import pytest

import lamina
from lamina.common import atomic

STACK = lamina.Stack([lamina.Medium(0.5, 1.0)])


def fifo(path):
    os.mkfifo(path)


def unix_socket(path):
    server = socket.socket(socket.AF_UNIX)
    server.bind(str(path))
    server.close()


@pytest.mark.parametrize("make", [fifo, unix_socket, os.mkdir])
@pytest.mark.parametrize("is_linked", [False, True])
def test_what_is_no_ordinary_file_stays(tmp_path, make, is_linked):
    special, given = tmp_path / "special", tmp_path / "special"
    make(special)
    if is_linked:
        given = tmp_path / "link"
        given.symlink_to(special)
    before = os.lstat(special), sorted(os.listdir(tmp_path))
    with pytest.raises(OSError) as caught:
        STACK.save(given)
    assert caught.value.filename == str(given) and caught.value.strerror
    assert os.path.samestat(os.lstat(special), before[0]) and sorted(os.listdir(tmp_path)) == before[1]


def test_a_link_stays_and_its_target_is_written(tmp_path):
    (tmp_path / "folder").mkdir()
    target, link, second = tmp_path / "folder/real.json", tmp_path / "link.json", tmp_path / "second.json"
    link.symlink_to(target)
    second.symlink_to(link.name)
    STACK.save(second)
    assert second.is_symlink() and link.is_symlink() and lamina.Stack.load(target).hash == STACK.hash
    assert os.listdir(tmp_path / "folder") == ["real.json"]


def test_a_failed_save_keeps_the_earlier_file_and_names_it(tmp_path):
    path = tmp_path / "kept"
    path.write_bytes(b"before")

    def fail(file):
        file.write(b"half")
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError) as caught:
        atomic.write_atomically(path, fail)
    assert (caught.value.errno, caught.value.filename) == (28, str(path))
    assert path.read_bytes() == b"before" and os.listdir(tmp_path) == ["kept"]
    with pytest.raises(FileNotFoundError) as caught:
        STACK.save(tmp_path / "none" / "x.json")
    assert caught.value.filename == str(tmp_path / "none" / "x.json")


KILLED = """
import os, signal, sys
from lamina.common import atomic
atomic.write_atomically(sys.argv[1], lambda file: os.kill(os.getpid(), signal.SIGKILL))
"""


def test_the_file_that_a_kill_leaves_goes_with_a_later_save(tmp_path):
    path = tmp_path / "a[b].json"
    subprocess.run([sys.executable, "-c", KILLED, path], check=False)
    (left,) = tmp_path.iterdir()
    assert left.suffix == ".part"
    STACK.save(path)
    assert left.exists(), "another process may be writing"
    old = time.time() - atomic.FORGOTTEN - 1.0
    os.utime(left, (old, old))
    STACK.save(path)
    assert os.listdir(tmp_path) == ["a[b].json"]


@pytest.mark.parametrize(("path", "says"), [
    ("", "path = '': must name a file"),
    ("a\0b", r"path = 'a\x00b': must name a file"),
    (5, "path = 5: must be a string or a Path"),
    (None, "path = None: must be a string or a Path"),
])
def test_what_cannot_name_a_file(path, says):
    with pytest.raises(lamina.ArgumentError) as caught:
        STACK.save(path)
    assert str(caught.value) == says


def test_a_reader_that_has_read_enough(tmp_path):
    command = [sys.executable, "-m", "lamina", "presets"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        process.stdout.close()
        assert process.stderr.read() == ""
    assert process.returncode == 141
