# SPDX-License-Identifier: GPL-3.0-or-later
"""python -m lamina, as called on a farm: exit codes, one sentence on stderr, files complete or unchanged."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import lamina
from lamina.cli import main

GOOD = {"schema": 1, "layers": [{"kind": "medium", "albedo": 0.9, "tau": 1.0, "phase": {"kind": "isotropic"}}],
        "base": {"kind": "black"}}
SLOW = {"schema": 1, "layers": [
    {"kind": "medium", "albedo": [0.9, 0.8, 0.7], "tau": 2.0, "phase": {"kind": "hg", "g": 0.75}, "varying": True},
    {"kind": "medium", "albedo": [0.99, 0.9, 0.5], "tau": 5.0, "phase": {"kind": "hg", "g": 0.6}}]}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("good.json").write_text(json.dumps(GOOD), encoding="utf-8")
    Path("slow.json").write_text(json.dumps(SLOW), encoding="utf-8")
    return tmp_path


def run(*arguments):
    return subprocess.run([sys.executable, "-m", "lamina", *arguments], capture_output=True, text=True, timeout=120)


def files(folder):
    return {p.name for p in folder.iterdir()} - {"good.json", "slow.json", "bad.json"}


def test_bake_and_report(folder):
    done = run("bake", "good.json", "-o", "out.npz", "--quality", "preview", "--threads", "1")
    assert done.returncode == 0 and all("%" in line for line in done.stderr.splitlines()) and "fit error" in done.stdout
    assert files(folder) == {"out.npz"}
    lut = lamina.Lut.load("out.npz")
    assert lut.header["stack_hash"] == lamina.Stack.load("good.json").hash
    report = run("report", "out.npz")
    assert report.returncode == 0 and report.stderr == ""
    assert f"{lut.report['fit_error']:.2%}" in report.stdout and lut.header["stack_hash"][:16] in report.stdout
    # The command is the function.
    lamina.bake(lamina.Stack.load("good.json"), "preview").save("direct.npz")
    assert Path("direct.npz").read_bytes() == Path("out.npz").read_bytes()


def test_a_name_that_the_terminal_cannot_show(folder, monkeypatch):
    Path("m\u00e8tre.json").write_text(json.dumps(GOOD), encoding="utf-8")
    monkeypatch.setenv("PYTHONIOENCODING", "ascii:strict")
    done = run("bake", "m\u00e8tre.json", "-o", "out.npz", "--quality", "preview", "--threads", "1")
    assert done.returncode == 0 and "m\\xe8tre.json: baked in" in done.stdout and Path("out.npz").is_file()


def test_version(capsys):
    with pytest.raises(SystemExit) as end:
        main(["--version"])
    assert end.value.code == 0 and capsys.readouterr().out == f"lamina {lamina.__version__}\n"


def test_the_basis_reaches_the_table(folder):
    stack = lamina.Stack([lamina.Medium(albedo=0.9, tau=2.0, phase=lamina.HenyeyGreenstein(0.75))], lamina.Black())
    stack.save("good.json")
    assert main(["bake", "good.json", "-o", "out.npz", "--quality", "preview", "--basis", "accurate", "--quiet"]) == 0
    accurate, standard = lamina.Lut.load("out.npz"), lamina.bake(stack, "preview")
    assert (accurate.header["basis"], standard.header["basis"]) == ("accurate", "standard")
    assert accurate.report["closures"] > standard.report["closures"]
    assert accurate.report["fit_error"] < standard.report["fit_error"]


def test_quiet_says_nothing(folder, capfd):
    assert main(["bake", "good.json", "-o", "out.npz", "--quality", "preview", "--quiet"]) == 0
    assert capfd.readouterr() == ("", "")


BAD = {
    "range": ('{"schema": 1, "layers": [{"kind": "medium", "albedo": 1.5, "tau": 1}]}',
              "lamina: bad.json: layers[0].albedo = 1.5: must lie in [0, 1]\n"),
    "NaN": ('{"schema": 1, "layers": [{"kind": "medium", "albedo": NaN, "tau": 1}]}',
            "lamina: bad.json: layers[0].albedo = nan: must lie in [0, 1]\n"),
    "unknown key": ('{"schema": 1, "layers": [], "colour": 1}',
                    "lamina: bad.json: stack.colour: unknown key; known are base, category, illuminant, layers, name, "
                    "schema, source, wavelengths\n"),
    "future": ('{"schema": 2, "layers": []}',
               "lamina: bad.json: schema = 2: must be at most 1; this stack needs a newer Lamina\n"),
    "empty stack": ('{"schema": 1, "layers": []}',
                    "lamina: bad.json: layers = []: a stack must hold at least one layer or a base\n"),
    "base in the middle": ('{"schema": 1, "layers": [{"kind": "black"}, {"kind": "medium", "albedo": 1, "tau": 1}]}',
                           "lamina: bad.json: layers[0].kind = 'black': a base can only stand at the bottom\n"),
    "kind a list": ('{"schema": 1, "layers": [{"kind": []}]}',
                    "lamina: bad.json: layers[0].kind = []: must be 'medium', 'interface', 'film', 'flakes', "
                    "'fibers', or a base "
                    "at the bottom\n"),
    "two channels": ('{"schema": 1, "layers": [{"kind": "medium", "albedo": [1, 1], "tau": 1}]}',
                     "lamina: channels = 2: must be 1 or 3 (R G B) for a lookup table\n"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_stacks(name, folder, capfd):
    content, sentence = BAD[name]
    Path("bad.json").write_text(content, encoding="utf-8")
    Path("old.npz").write_bytes(b"an earlier bake")
    assert main(["bake", "bad.json", "-o", "new.npz"]) == 2
    assert capfd.readouterr() == ("", sentence)
    assert main(["bake", "bad.json", "-o", "old.npz"]) == 2
    assert files(folder) == {"old.npz"} and Path("old.npz").read_bytes() == b"an earlier bake"


def test_bad_stack_in_a_process_of_its_own(folder):
    Path("bad.json").write_text(BAD["range"][0], encoding="utf-8")
    done = run("bake", "bad.json", "-o", "out.npz")
    assert (done.returncode, done.stdout, done.stderr) == (2, "", BAD["range"][1]) and files(folder) == set()


@pytest.mark.parametrize("content", [b"", b"{", b"\x00\xff\xfe", b"[" * 100_000],
                         ids=["empty", "cut", "binary", "deep"])
def test_stacks_that_are_not_json(content, folder, capfd):
    Path("bad.json").write_bytes(content)
    assert main(["bake", "bad.json", "-o", "out.npz"]) == 2
    out, err = capfd.readouterr()
    assert out == "" and err.startswith("lamina: bad.json: ") and err.count("\n") == 1 and files(folder) == set()


@pytest.mark.parametrize("arguments", [
    ("bake", "none.json", "-o", "out.npz"), ("bake", "good.json", "-o", "."), ("bake", "good.json", "-o", "no/out.npz"),
    ("report", "none.npz"), ("report", ".")])
def test_paths_that_do_not_work(arguments, folder, capfd):
    assert main(list(arguments)) in (1, 2)
    out, err = capfd.readouterr()
    assert out == "" and err.startswith("lamina: ") and err.count("\n") == 1 and files(folder) == set()


@pytest.mark.parametrize("arguments", [
    ("bake",), ("bake", "good.json"), ("bake", "good.json", "-o", "x.npz", "--quality", "best"),
    ("bake", "good.json", "-o", "x.npz", "--threads", "-1"), ("boil", "good.json")])
def test_bad_arguments(arguments, folder, capfd):
    with pytest.raises(SystemExit) as caught:
        main(list(arguments))
    assert caught.value.code == 2 and "Traceback" not in capfd.readouterr().err and files(folder) == set()


def test_what_cannot_be_resolved_fails_with_the_numbers(folder, capfd):
    phase = {"kind": "tabulated", "moments": [(-0.98) ** k for k in range(1000)]}
    layer = {"kind": "medium", "albedo": 1.0, "tau": 1.0, "phase": phase}
    Path("bad.json").write_text(json.dumps({"schema": 1, "layers": [layer]}), encoding="utf-8")
    assert main(["bake", "bad.json", "-o", "out.npz", "--quiet"]) == 1
    out, err = capfd.readouterr()
    assert out == "" and "cannot be resolved" in err and err.count("\n") == 1 and files(folder) == set()


class TestReport:
    @pytest.fixture
    def baked(self, folder):
        lamina.bake(lamina.Stack.from_json(GOOD), "preview").save("out.npz")
        return Path("out.npz")

    @pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
    def test_truncated(self, baked, share, capfd):
        content = baked.read_bytes()
        baked.write_bytes(content[: int(share * len(content))])
        assert main(["report", "out.npz"]) == 2
        reason = "no .npz archive" if share == 0.0 else "the archive is truncated or damaged"
        assert capfd.readouterr() == ("", f"lamina: out.npz: not a complete Lamina lookup table: {reason}\n")

    def test_foreign(self, folder, capfd):
        assert main(["report", "good.json"]) == 2
        assert capfd.readouterr() == ("", "lamina: good.json: not a complete Lamina lookup table: no .npz archive\n")

    def test_newer(self, baked, capfd):
        lut = lamina.Lut.load(baked)
        lamina.Lut({**lut.header, "schema": 3}, lut.weights).save(baked)
        assert main(["report", "out.npz"]) == 2
        assert capfd.readouterr() == ("", "lamina: out.npz: schema 3 needs a newer Lamina, which reads up to 2\n")

    def test_incomplete(self, baked, capfd):
        lut = lamina.Lut.load(baked)
        lamina.Lut({**lut.header, "report": {}}, lut.weights).save(baked)
        assert main(["report", "out.npz"]) == 2
        assert capfd.readouterr().err == (
            "lamina: out.npz: the header of the lookup table is incomplete: "
            "report.fit_error is missing\n")


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals and terminals")
@pytest.mark.parametrize("wait_for", [b"Solving thickness", b"Evaluating"])
def test_interrupting_a_bake(folder, wait_for):
    """Ctrl-C in mid-bake: one sentence, no half file, the earlier bake intact."""
    Path("old.npz").write_bytes(b"an earlier bake")
    # On a terminal progress is shown at once, which gives the state of the bake.
    screen, terminal = os.openpty()
    process = subprocess.Popen([sys.executable, "-m", "lamina", "bake", "slow.json", "-o", "old.npz"],
                               stdout=subprocess.DEVNULL, stderr=terminal, start_new_session=True,
                               # Shells make background processes ignore it.
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    os.close(terminal)
    shown, deadline = b"", time.monotonic() + 60.0
    while wait_for not in shown:
        assert time.monotonic() < deadline, shown
        shown += os.read(screen, 4096)
    process.send_signal(signal.SIGINT)
    try:
        while chunk := os.read(screen, 4096):
            shown += chunk
    except OSError:
        pass  # Linux reports the closed terminal so.
    os.close(screen)
    assert process.wait(timeout=60) == 130
    assert b"\r\x1b[Klamina: interrupted; nothing was written" in shown and b"Traceback" not in shown
    assert files(folder) == {"old.npz"} and Path("old.npz").read_bytes() == b"an earlier bake"


COMMANDS = {
    "bake": ["bake", "missing.json", "-o", "out.npz"],
    "export": ["export", "missing.json", "-o", "out.npz"],
    "estimate": ["estimate", "missing.json", "--mu-i", "0.5"],
    "dust": ["dust", "missing.ply", "-o", "out.npz"],
}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(("flag", "text", "rule"), [
    ("--threads", "5000", "must be a whole number from 0 (all) to 1024"),
    ("--threads", "-1", "must be a whole number from 0 (all) to 1024"),
    ("--threads", "x", "must be a whole number from 0 (all) to 1024"),
    ("--seed", "-1", "must be a whole number from 0 to 2^64 - 1"),
    ("--seed", "x", "must be a whole number from 0 to 2^64 - 1"),
    ("--seed", str(1 << 64), "must be a whole number from 0 to 2^64 - 1"),
])
def test_threads_and_seeds_have_one_rule(command, flag, text, rule, capsys):
    """Exit code 2, before any file is read; commands without random numbers have no seed."""
    try:
        code = main([*COMMANDS[command], flag, text])
    except SystemExit as ended:
        code = ended.code
    told = capsys.readouterr().err
    assert code == 2 and told.startswith("lamina: ") and told.count("\n") == 1
    if flag == "--seed" and command in ("bake", "export"):
        assert "unrecognized arguments: --seed" in told
    else:
        assert f"{text}: {rule}" in told
