# SPDX-License-Identifier: GPL-3.0-or-later
"""Without a usable native module the add-on can be enabled, and panel, operators and CLI give the same sentence."""

import importlib
import sys
import sysconfig

import bpy
import pytest

SUFFIX = sysconfig.get_config_var("EXT_SUFFIX")
OTHER = ".cpython-39-x86_64-linux-gnu.so"

CASES = {
    "absent": (None, "is not installed for Python"),
    "other Python": (
        {"__init__.py": "from . import _core", f"_core{OTHER}": ""},
        "was built for another Python",
    ),
    "no compiled module": ({"__init__.py": "from . import _core"}, "is missing from its package"),
    "damaged": (
        {"__init__.py": "from . import _core", f"_core{SUFFIX}": "rubbish"},
        "does not load: ImportError",
    ),
    "broken": (
        {"__init__.py": "raise RuntimeError('no AVX2\\nhere')"},
        "does not load: RuntimeError: no AVX2 here",
    ),
    "too old": ({"__init__.py": "", "lobes.py": ""}, "does not load: AttributeError"),
}


@pytest.fixture
def broken(addon, monkeypatch, tmp_path, request):
    """The add-on, newly enabled while `lamina` is in the state of the case."""
    files, sentence = CASES[request.param]
    kept = {
        name: module for name, module in sys.modules.items() if name == "lamina" or name.startswith("lamina.")
    }
    for name in kept:
        del sys.modules[name]
    if files is None:
        find = importlib.util.find_spec
        monkeypatch.setattr(
            importlib.util, "find_spec", lambda name, *rest: None if name == "lamina" else find(name)
        )
        monkeypatch.setitem(sys.modules, "lamina", None)
    else:
        folder = tmp_path / "lamina"
        folder.mkdir()
        for name, text in files.items():
            (folder / name).write_text(text)
        monkeypatch.syspath_prepend(str(tmp_path))
    addon.unregister()
    addon.register()
    yield addon, sentence
    monkeypatch.undo()
    for name in [name for name in sys.modules if name == "lamina" or name.startswith("lamina.")]:
        del sys.modules[name]
    sys.modules.update(kept)
    addon.base.native.load()


@pytest.mark.parametrize("broken", CASES, indirect=True)
def test_one_sentence_everywhere(broken, call, capsys):
    addon, sentence = broken
    assert not addon.base.native.available()
    reason = addon.base.native.reason()
    assert sentence in reason and "\n" not in reason and "Traceback" not in reason
    material = bpy.data.materials.new("Dusty")
    call(bpy.ops.lamina.add_stack, material)
    call(bpy.ops.lamina.layer_add, material)
    with pytest.raises(RuntimeError, match="native module"):
        call(bpy.ops.lamina.bake, material)
    with pytest.raises(addon.base.native.NativeMissingError):
        addon.baking.bake_job.bake_material(material)
    capsys.readouterr()
    assert addon.command_line.command.main(["bake"]) == 1
    assert capsys.readouterr().err == f"lamina: {reason}\n"
    assert addon.command_line.command.main(["list"]) == 1
    printed = capsys.readouterr()
    assert printed.out == "Dusty: 2 layers, not baked\n" and printed.err == f"lamina: {reason}\n"
    assert addon.ui.state_line.stack_error(material) == ""


def test_a_wheel_that_arrives_later_is_found(addon, lamina):
    addon.base.native._package, addon.base.native._reason = None, "gone"
    addon.unregister()
    addon.register()
    assert addon.base.native.available() and addon.base.native.reason() == ""


def test_a_build_that_replaces_the_loaded_one(addon, lamina, monkeypatch):
    """Blender keeps the old modules in memory until its next start."""
    monkeypatch.setattr(lamina, "_written", lamina._written - 1)
    try:
        addon.base.native.load()
        assert not addon.base.native.available()
        assert addon.base.native.reason() == addon.base.native.REPLACED
    finally:
        monkeypatch.undo()
        addon.base.native.load()
    assert addon.base.native.available()
