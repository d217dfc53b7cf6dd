# SPDX-License-Identifier: GPL-3.0-or-later
"""The descriptions from which `lamina` makes its checks and the add-on its panel."""

import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from measured_tables import facets, measured

import lamina
from lamina import Medium, Stack, StackError, _core
from lamina.kinds import bases, boundaries, flakes, interiors, layers, media, phases
from lamina.kinds.dust import OPTIONS
from lamina.kinds.fields import Field, all_fields

QUANTITIES = {
    **{f"{cls.kind}.{field.name}": field for cls in phases.KINDS for field in cls.fields},
    **{f"medium.{field.name}": field for form in media.FORMS for field in form},
    **{f"interface.{field.name}": field for field in boundaries.Interface.fields},
    **{f"{kind}.{field.name}": field for kind, cls in layers.DESCRIBED.items() for field in all_fields(cls)},
    **{f"{cls.kind}.{field.name}": field for cls in bases.KINDS for form in (cls.fields, *cls.forms) for field in form},
    **{f"interior.{field.name}": field for field in
       (*interiors.GROUND, *interiors.MARBLE, *interiors.BODY, *interiors.MAPS) if field.name != "seed"},
}
FIELDS = {name: field for name, field in QUANTITIES.items() if isinstance(field, Field)}


@pytest.mark.parametrize("field", FIELDS.values(), ids=FIELDS)
def test_the_range_and_its_sentence_agree(field):
    """The ends of a range are allowed or refused according to the message's brackets; the panel's range is allowed."""
    inside = field.low + 1 if field.whole else 0.5 * (field.low + min(field.high, field.low + 1.0))
    assert field.check(inside, "x") == inside
    for end, bracket in ((field.low, "("), (field.high, ")")):
        if bracket in field.rule.removesuffix(field.unit):
            with pytest.raises(StackError, match=r"must lie in \("):
                field.check(end, "x")
        else:
            assert field.check(end, "x") == end
    if field.whole:
        with pytest.raises(StackError, match=f"^x = {inside + 0.5}: must be a whole number from"):
            field.check(inside + 0.5, "x")
    for outside in (field.low - 1.0, np.nextafter(field.low, -np.inf), np.nextafter(field.high, np.inf)):
        if not (field.infinite and np.isinf(outside)):
            with pytest.raises(StackError, match="^x = "):
                field.check(outside, "x")
    if field.panel is not None:
        low = field.low if field.panel.low is None else field.panel.low
        high = field.high if field.panel.high is None else field.panel.high
        for value in (low, high, *np.atleast_1d(field.panel.default)):
            field.check(float(value), "x")


@pytest.mark.parametrize(("file", "name"), [
    ("core/phase/test_phase.py", "DRAWN"), ("lamina/material/test_phase_in_stack.py", "ALL"),
    ("lamina/solver/test_phase_solves.py", "PHASES"), ("lamina/walk_cases.py", "CASES"),
])
def test_an_added_phase_function_is_in_the_lists_of_the_tests(file, name, monkeypatch):
    class Added(lamina.HenyeyGreenstein):
        pass

    tests = Path(__file__).parents[2]
    for helpers in ("core", "core/phase"):  # pytest adds these folders only when it collects their tests too
        monkeypatch.syspath_prepend(tests / helpers)
    path = str(tests / file)
    before = runpy.run_path(path)[name]
    monkeypatch.setattr(phases, "KINDS", (*phases.KINDS, Added))
    assert len(runpy.run_path(path)[name]) > len(before)


@pytest.mark.parametrize("cls", phases.KINDS, ids=lambda cls: cls.kind)
def test_the_core_takes_every_phase_function(cls):
    """Kind and parameters in the described order: normalised, and of the panel's defaults."""
    phase = cls(**{field.name: field.panel.default for field in cls.fields})
    function = _core.PhaseFunction(*phase.in_channel(0))
    mu, weight = np.polynomial.legendre.leggauss(200)
    whole = 0.5 * np.sum(weight * function.evaluate(mu))
    assert whole == pytest.approx(1.0, abs=1e-9)
    assert getattr(lamina, cls.__name__) is cls and cls.__name__ in lamina.__all__
    data = {"schema": 1, "layers": [Stack([Medium(albedo=0.5, tau=1.0, phase=phase)]).to_json()["layers"][0]]}
    assert Stack.from_json(data).layers[0].phase == phase


@pytest.mark.parametrize("cls", bases.KINDS, ids=lambda cls: cls.kind)
def test_every_base_can_be_solved_and_read_back(cls):
    fields = (*(cls.forms[0] if cls.forms else ()), *cls.fields)
    texts = {"table": measured(facets(0.2, 0.1, 0.3)).table} if cls is lamina.Measured else {}
    base = cls(**{field.name: field.panel.default for field in fields}, **texts)
    stack = Stack([Medium(albedo=0.5, tau=0.5)], base)
    solved = lamina.solve(stack, "preview")
    assert np.all(solved.reflectance(0.5) + solved.transmittance(0.5) <= 1.0 + 1e-3)
    assert Stack.from_json(stack.to_json()) == stack
    assert getattr(lamina, cls.__name__) is cls and cls.__name__ in lamina.__all__


def test_numbers_of_choices_are_their_own():
    """A .blend file stores the number of a choice."""
    lists = [[media.ITEM, boundaries.Interface.item, *(cls.item for cls in layers.DESCRIBED.values())],
             [cls.item for cls in phases.IN_PANEL], [bases.NONE, *(cls.item for cls in bases.IN_PANEL)],
             [form.item for form in media.FORMS]]
    lists += [[form.item for form in cls.forms] for cls in (*bases.KINDS, flakes.Flakes) if cls.form_prop]
    for items in lists:
        assert len({item.number for item in items}) == len({item.id for item in items}) == len(items)
    assert set(phases.IN_PANEL) == set(phases.KINDS) and set(bases.IN_PANEL) == set(bases.KINDS)


@pytest.mark.parametrize("field", interiors.MARBLE, ids=lambda field: field.name)
def test_marble_takes_what_its_fields_describe(field):
    for end in (field.low, field.high):
        value = int(end) if field.whole else end
        assert getattr(lamina.Marble(**{field.name: value}), field.name) == value
    for outside in (field.low - 1, field.high + 1, "1", None):
        with pytest.raises(lamina.InteriorError) as raised:
            lamina.Marble(**{field.name: outside})
        assert str(raised.value).startswith(f"{field.name} = ") and str(raised.value).endswith(field.rule)


@pytest.mark.parametrize("field", interiors.GROUND, ids=lambda field: field.name)
def test_an_end_material_takes_what_its_fields_describe(field):
    usual = interiors.defaults(interiors.GROUND)
    lamina.EndMaterial(**usual | {field.name: field.high})
    for outside in (np.nextafter(field.low, -np.inf), np.nextafter(field.high, np.inf), np.nan):
        with pytest.raises(lamina.InteriorError, match=f"^{field.name} = .*must lie in"):
            lamina.EndMaterial(**usual | {field.name: outside})


def test_every_option_of_settling_is_checked():
    for option in OPTIONS:
        if not option.switch:
            with pytest.raises(lamina.DustError, match=f"^settling.{option.name} = "):
                lamina.dust.Settling(**{option.name: option.high * 1.01 + 1.0})


def test_the_room_stands_alone():
    """The add-on loads these files where there is neither numpy nor the compiled package."""
    script = """
import importlib.util, pathlib, sys
sys.modules["numpy"] = sys.modules["lamina"] = None
folder = pathlib.Path(sys.argv[1])
spec = importlib.util.spec_from_file_location("alone", folder / "__init__.py", submodule_search_locations=[str(folder)])
package = importlib.util.module_from_spec(spec)
sys.modules["alone"] = package
spec.loader.exec_module(package)
for file in sorted(folder.glob("*.py")):
    importlib.import_module("alone." + file.stem)
print(len(sys.modules["alone.metals"].table()))
"""
    folder = Path(lamina.__file__).parent / "kinds"
    done = subprocess.run([sys.executable, "-c", script, folder], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) == len(lamina.metals.names())
