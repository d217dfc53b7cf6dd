# SPDX-License-Identifier: GPL-3.0-or-later
"""Free parameters, their sums, and templates."""

import numpy as np
import pytest

import lamina
from lamina import Free, HenyeyGreenstein, Interface, Knot, Lambert, Medium, Mixture, Stack, Template


def test_sums_of_parameters_are_quantities():
    """Two absorbers with spectra, and shares of a mixture that sum to one."""
    chlorophyll, water, share = Free(2.0, 0.0, 10.0, "c"), Free(0.5, 0.0, 1.0, "w"), Free(0.3, 0.0, 1.0, "share")
    spectrum = np.array([0.3, 0.1, 0.4])
    absorbed = spectrum * chlorophyll + water * [0.0, 0.0, 1.0] + 0.01
    lobes = Mixture([(share, HenyeyGreenstein(0.8)), (1.0 - share, HenyeyGreenstein(-0.2))])
    template = Template([Medium(sigma_s=5.0, sigma_a=absorbed, thickness=0.2, phase=lobes)])
    assert set(template.parameters) == {"c", "w", "share"}
    stack = template.stack({"c": 4.0, "w": 0.25, "share": 0.75})
    assert stack.layers[0].sigma_a == pytest.approx([1.21, 0.41, 1.86])
    assert stack.layers[0].phase.parts[1][0] == 0.25
    assert (-chlorophyll / 2.0 - 1.0).value({chlorophyll: 4.0}) == -3.0
    assert (water - chlorophyll).value({chlorophyll: 4.0, water: 1.0}) == -3.0


def test_parameters_stand_anywhere():
    base, ior, depth = Free(0.5, 0, 1), Free(1.4, 1.3, 1.6), Free(0.8, 0.1, 0.9)
    template = Template([Interface(ior), Medium(tau=1.0, profile=[
        Knot(0.0, albedo=depth), Knot(1.0, albedo=0.5, phase=HenyeyGreenstein(Free(0.1, 0, 0.5)))]), Lambert(base)])
    assert list(template.parameters) == ["layers[0].ior", "layers[1].profile[0].albedo",
                                         "layers[1].profile[1].phase.g", "base.reflectance"]
    assert template.stack({name: free.low for name, free in template.parameters.items()}).layers[0].ior == 1.3


def test_changes_of_parts():
    template = Template([Medium(sigma_s=1.0, sigma_a=Free(0.1, 0, 1), thickness=1.0, phase=HenyeyGreenstein(0.2))],
                        Lambert(0.5))
    values = {"layers[0].sigma_a": 0.1}
    changed = template.changed({"base.reflectance": 0.1, "layers[0].phase.g": 0.4, "layers[0].thickness": [1.0, 2.0]})
    assert changed.stack(values) == Stack([Medium(sigma_s=1.0, sigma_a=0.1, thickness=[1.0, 2.0],
                                                  phase=HenyeyGreenstein(0.4))], Lambert(0.1))
    assert template.changed({"base": None}).stack(values).base is None
    for path, message in (("base.tau", "the template has no tau there"), ("layer[0].tau", "must be 'base', or a path"),
                          ("layers[1].tau", "has 1 layers"), (3, "must be 'base', or a path")):
        with pytest.raises(lamina.ArgumentError, match=message):
            template.changed({path: 1.0})


@pytest.mark.parametrize(("make", "message"), [
    (lambda: Free(0.5, 1.0, 0.0), "low = 1: must be less than high = 0"),
    (lambda: Free(2.0, 0.0, 1.0), r"start = 2: must lie in \[0, 1\]"),
    (lambda: Free(float("nan"), 0.0, 1.0), "start = nan: must be a finite number"),
    (lambda: Free(0.5, 0.0, float("inf")), "high = inf: must be a finite number"),
    (lambda: Free(0.5, 0.0, 1.0, name=3), "name = 3: must be a text"),
    (lambda: Free(0.5, 0, 1) * Free(0.5, 0, 1), "a product of two free quantities"),
    (lambda: 1.0 + Free(0.5, 0, 1) / Free(0.5, 0, 1), "a quotient by a free quantity"),
    (lambda: Free(0.5, 0, 1) * [1.0, 2.0] + [1.0, 2.0, 3.0], "must have equal numbers"),
    (lambda: Free(0.5, 0, 1) * "x", "coefficients = 'x'"),
    (lambda: Free(0.5, 0, 1) / 0, "a quotient by 0: must be a quotient by numbers other than 0"),
    (lambda: Free(0.5, 0, 1) / [1.0, 0.0], r"a quotient by \[1.0, 0.0\]: must be a quotient by numbers other than 0"),
    (lambda: Template([], Lambert(Free(0.5, 0, 1, "r"))).stack({"r": "x"}), r"values\['r'\] = 'x': must be a finite"),
    (lambda: Template([], Lambert(Free(0.5, 0, 1, "r"))).stack({"r": None}), r"values\['r'\] = None: must be a finite"),
    (lambda: Template([Medium(albedo=Free(0.5, 0, 1, "a"), tau=Free(0.5, 0, 1, "a"))]), "two free parameters have"),
    (lambda: Template([Medium(albedo=Free(0.5, 0, 2), tau=1.0)]), r"layers\[0\].albedo = 2: must lie in \[0, 1\]"),
    (lambda: Template([Medium(albedo=Free(0.5, 0, 1))]), r"layers\[0\].tau is missing"),
    (lambda: Template([], None), "must hold at least one layer or a base"),
    (lambda: Template([], Lambert(Free(0.5, 0, 1))).stack({"r": 0.5}), "must be a dict with a number for each of base"),
    (lambda: Template([], Lambert(Free(0.5, 0, 1))).stack(0.5), "values = 0.5: must be a dict"),
    (lambda: Template([], Lambert(Free(0.5, 0, 1))).changed([1]), r"changes = \[1\]: must be a dict of values by path"),
    (lambda: Template("slab"), "must be a list, top layer first"),
])
def test_bad_input_gets_one_sentence(make, message):
    with pytest.raises(ValueError, match=message) as error:
        make()
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("across", [0.4, Free(0.3, 0.1, 0.5)])
def test_anisotropic_facets_are_refused(across):
    template = Template([Interface(1.5, alpha=0.1, alpha_v=across)], Lambert(Free(0.5, 0.0, 1.0)))
    data = lamina.measurements.Reflectance(np.array([0.9, 0.5, 0.3]), values=np.full(3, 0.7), sigma=0.01)
    with pytest.raises(lamina.StackError, match=r"layers\[0\].alpha_v.*a fit"):
        lamina.fit([data], template)
