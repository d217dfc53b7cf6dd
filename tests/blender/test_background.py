# SPDX-License-Identifier: GPL-3.0-or-later
"""`blender -b` with the installed extension: batch, pictures with and without the add-on, dust, a full disk, a kill."""

import re
import signal
import statistics
import time

import pytest
from chroot_blender import INSIDE

BATCH = ("--python-exit-code", "1", "--command", "lamina")


@pytest.fixture
def made(blender, request):
    """made(count): path inside of a new file with `count` materials with dust that are not baked."""

    def make(count):
        name = f"{INSIDE}/{re.sub(r'[^a-z0-9]+', '-', request.node.name)}.blend"
        finished = script(blender, "make_file.py", name, count)
        assert finished.returncode == 0, finished.stderr
        return name

    return make


def script(blender, name, *arguments, file=None, options=()):
    opened = [file] if file else []
    return blender.run(*options, *opened, "--python-exit-code", "1", "--python", f"{INSIDE}/{name}", "--",
                       *map(str, arguments))


def states(blender, file):
    finished = blender.run(file, *BATCH, "list")
    assert finished.returncode == 0, finished.stderr
    return dict(re.findall(r"^(Dusty \d): .*?layers?, (.*)$", finished.stdout, re.MULTILINE))


def told(text, word):
    """The value after `word:` in what a script printed."""
    return re.search(rf"{word}: (\S+)", text)[1]


def test_batch_and_the_picture_without_the_add_on(blender, made):
    """The baked file renders the same pixels with and without the add-on."""
    file = made(2)
    assert states(blender, file) == {"Dusty 0": "not baked", "Dusty 1": "not baked"}
    before = script(blender, "picture.py", file=file).stdout
    baked = blender.run(file, *BATCH, "bake", "--save")
    assert baked.returncode == 0 and "Traceback" not in baked.stderr, baked.stdout + baked.stderr
    assert states(blender, file) == {"Dusty 0": "up to date", "Dusty 1": "up to date"}
    enabled = script(blender, "picture.py", file=file).stdout
    disabled = script(blender, "picture.py", file=file, options=["--factory-startup"]).stdout
    assert told(enabled, "lamina") == "True" and told(disabled, "lamina") == "False"
    assert told(enabled, "pixels") == told(disabled, "pixels") != told(before, "pixels")
    assert float(told(enabled, "mean")) > 0.0


@pytest.mark.parametrize(("arguments", "code"), [
    (("bake", "Dusty*", "--output", f"{INSIDE}/other.blend"), 0),
    (("bake", "Nothing*", "--save"), 2),
    (("bake", "--quality", "finest"), 2),
    (("bake", "--save", "--threads", "-1"), 2),
    (("bake", "--output", f"{INSIDE}/no/folder/x.blend"), 2),
])
def test_exit_codes(blender, made, arguments, code):
    finished = blender.run(made(1), *BATCH, *arguments)
    assert finished.returncode == code and "Traceback" not in finished.stderr, finished.stdout + finished.stderr


def test_dust(blender, made):
    """The usual amount of 1 lies on the open upper face alone, and no dust below a roof."""
    finished = script(blender, "dust.py", file=made(1))
    assert finished.returncode == 0, finished.stdout + finished.stderr
    upper, others, roofed = (float(told(finished.stdout, word)) for word in ("upper", "others", "roofed"))
    assert upper == pytest.approx(1.0, rel=1e-5)
    assert others == pytest.approx(0.0, abs=1e-5) and roofed == pytest.approx(0.0, abs=1e-5)


def test_a_kill_in_the_middle(blender, made):
    """SIGKILL after the first material: the file is whole, and the next batch finishes."""
    file = made(6)
    with blender.started(file, *BATCH, "bake", "--save") as process:
        for line in process.stdout:
            if line.startswith("Dusty 0"):
                break
        process.kill()
    assert process.returncode == -signal.SIGKILL, "the batch had ended before the kill"
    time.sleep(0.5)
    assert len(states(blender, file)) == 6
    finished = blender.run(file, *BATCH, "bake", "--save")
    assert finished.returncode == 0, finished.stdout + finished.stderr
    assert set(states(blender, file).values()) == {"up to date"}


READ_ONLY = 'mount --bind "$root/mnt/locked" "$root/mnt/locked" && mount -o remount,bind,ro "$root/mnt/locked"'
# What the file leaves free is filled up: the size of a saved file differs from Blender to Blender.
FULL = ('mount -t tmpfs -o size=1m none "$root/mnt/locked" && cp "$root/mnt/file.blend" "$root/mnt/locked/" && '
        '{ cat /dev/zero >"$root/mnt/locked/rest" 2>/dev/null || true; }')


@pytest.mark.parametrize("mounts", [READ_ONLY, FULL], ids=["read-only", "full disk"])
def test_a_folder_that_takes_no_file(blender, made, mounts):
    """Exit code 1 and one sentence; the file is as before."""
    (blender.folder / "locked").mkdir(exist_ok=True)
    source = (blender.folder / made(1).removeprefix(f"{INSIDE}/")).read_bytes()
    for copy in ("locked/file.blend", "file.blend"):
        (blender.folder / copy).write_bytes(source)
    finished = blender.run(f"{INSIDE}/locked/file.blend", *BATCH, "bake", "--save",
                           mounts=mounts, after='cp "$root/mnt/locked/file.blend" "$root/mnt/after.blend"')
    assert finished.returncode == 1 and "Traceback" not in finished.stderr, finished.stdout + finished.stderr
    assert re.search(r"lamina: .{20,}", finished.stderr)
    assert (blender.folder / "after.blend").read_bytes() == source


def test_bakes_do_not_accumulate(blender, made):
    finished = script(blender, "rebake.py", file=made(1))
    assert finished.returncode == 0, finished.stdout + finished.stderr
    found = re.findall(r"bakes: \d+ (\d+) (\d+) (\d+)", finished.stdout)
    counts = {numbers[:2] for numbers in found}
    memory = [int(numbers[2]) for numbers in found]
    assert len(found) == 81 and len(counts) == 1
    # Means, since the memory of a process goes up and down by 15 MB.
    assert statistics.mean(memory[-20:]) - statistics.mean(memory[:20]) < 20_000  # kB
