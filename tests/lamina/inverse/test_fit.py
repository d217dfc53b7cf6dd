# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits of noisy values with known truth: standard errors, chi-squared, and what the data cannot tell."""

import pickle
import sys

import numpy as np
import pytest
from fit_cases import NAMES, free_slab, noisy_case, slab
from scipy import stats

import lamina
from lamina import Free, HenyeyGreenstein, Lambert, Medium, Stack, Template
from lamina.measurements import Brdf, Profile, Reflectance, Transmittance

CASES = 40
LEVEL = 1e-3


def test_stated_errors_are_right():
    """Truth lies within two standard errors as often as it should, and probabilities of chi-squared are uniform."""
    within, probabilities = np.zeros(3, int), []
    for seed in range(1000, 1000 + CASES):
        truth, measured = noisy_case(seed)
        fit = lamina.fit(measured, free_slab())
        scores = [(fit.values[name] - value) / fit.errors[name] for name, value in zip(NAMES, truth, strict=True)]
        within += np.abs(scores) < 2.0
        probabilities.append(fit.probability)
    share = stats.norm.cdf(2.0) - stats.norm.cdf(-2.0)
    assert np.all(within >= stats.binom.ppf(LEVEL / 3, CASES, share)), within
    assert stats.kstest(probabilities, "uniform").pvalue > LEVEL


def test_standard_error_of_one_parameter():
    """sigma over the derivative, taken from checked solves at two reflectances."""
    def paint(reflectance):
        return Template([Medium(albedo=0.8, tau=1.0)], Lambert(reflectance))
    values = [lamina.solve(Stack([Medium(albedo=0.8, tau=1.0)], Lambert(r))).reflectance("diffuse")[0]
              for r in (0.39, 0.4, 0.41)]
    fit = lamina.fit(Reflectance(values=values[1], sigma=0.01, mu_i="diffuse"), paint(Free(0.7, 0.0, 1.0)))
    assert fit.names == ("base.reflectance",)
    assert fit.values["base.reflectance"] == pytest.approx(0.4, abs=1e-4)
    assert fit.errors["base.reflectance"] == pytest.approx(0.01 * 0.02 / (values[2] - values[0]), rel=2e-3)
    assert fit.degrees == 0 and np.isnan(fit.probability)
    assert "as many values as parameters" in fit.remarks[0]


def test_exact_values_give_the_stack_back():
    """Rough boundaries, channels, both sides, and a parameter that two layers share."""
    def layers(albedo, g, alpha):
        phase = HenyeyGreenstein(g)
        return [lamina.Interface(1.5, alpha=alpha), Medium(albedo=albedo, tau=1.0, phase=phase),
                Medium(albedo=0.9, tau=[0.5, 1.0, 2.0], phase=phase), lamina.Interface(1.0)]
    truth = Stack(layers([0.9, 0.7, 0.5], 0.6, 0.3))
    solved = lamina.solve(truth)
    mu_o, mu_i, dphi = np.array([[0.9, 0.6, 0.4], [0.5, 0.7, 0.3], [0.0, 1.5, 3.0]])
    shared = Free(0.2, -0.9, 0.9, "g")
    template = Template(layers([Free(0.8, 0, 1), Free(0.8, 0, 1), Free(0.8, 0, 1)], shared, Free(0.15, 0.05, 0.6)))
    assert list(template.parameters) == ["layers[0].alpha", *(f"layers[1].albedo[{c}]" for c in range(3)), "g"]
    fit = lamina.fit([
        Brdf(values=solved.brdf(mu_o, mu_i, dphi), relative=0.01, mu_o=mu_o, mu_i=mu_i, dphi=dphi),
        Reflectance(values=solved.reflectance([0.3, 0.9], side="bottom"), sigma=1e-3, mu_i=[0.3, 0.9], side="bottom"),
        Transmittance(values=solved.transmittance("diffuse"), sigma=1e-3, mu_i="diffuse")], template)
    assert np.max(np.abs(np.concatenate([part.ravel() for part in fit.residuals]))) < 0.1
    scores = [(value - true) / fit.errors[name] for (name, value), true in
              zip(fit.values.items(), [0.3, 0.9, 0.7, 0.5, 0.6], strict=True)]
    assert np.max(np.abs(scores)) < 0.1, scores
    assert fit.stack.layers[1].phase == fit.stack.layers[2].phase == HenyeyGreenstein(fit.values["g"])
    assert "sigma is too large" in " ".join(fit.remarks)


def test_a_wrong_template_says_so():
    """Values of two lobes do not fit isotropic scattering."""
    _, measured = noisy_case(5)
    wrong = Template([Medium(albedo=Free(0.8, 0.0, 1.0), tau=Free(1.0, 0.05, 20.0))])
    fit = lamina.fit(measured, wrong)
    assert fit.probability < 1e-6
    assert "does not describe the data" in " ".join(fit.remarks) and "does not describe" in str(fit)


def test_what_the_data_cannot_tell():
    """One value cannot give two parameters; thick layers do not show their thickness."""
    solved = lamina.solve(Stack(slab(0.9, 0.3, 2.0)))
    twice = [Reflectance(values=solved.reflectance("diffuse"), sigma=1e-3, mu_i="diffuse") for _ in range(2)]
    template = Template(slab(Free(0.8, 0.0, 1.0, "albedo"), 0.3, Free(1.0, 0.05, 20.0, "tau")))
    fit = lamina.fit(twice, template)
    assert any("cannot tell albedo and tau apart" in one or "do not determine" in one for one in fit.remarks)
    thick = lamina.solve(Stack(slab(0.6, 0.0, 60.0)))
    mu = np.array([0.2, 0.5, 0.9])
    fit = lamina.fit(Reflectance(values=thick.reflectance(mu), sigma=1e-3, mu_i=mu),
                     Template(slab(Free(0.7, 0.0, 1.0, "albedo"), 0.0, Free(50.0, 30.0, 90.0, "tau"))))
    assert "The data do not determine tau." in fit.remarks
    assert fit.errors["albedo"] < 0.01 < 10.0 < fit.errors["tau"]


def test_each_remark_is_made_once():
    """Two directions of the parameters that noise leaves open may have the same members."""
    half = 0.5 * Free(0.5, 0.0, 1.0, "a") + 0.5 * Free(0.5, 0.0, 1.0, "b")
    fit = lamina.fit(Reflectance(values=[0.2, 0.3], sigma=10.0, mu_i=[0.5, 0.9]), Template([], Lambert(half)))
    assert fit.remarks.count("The data cannot tell a and b apart.") == 1


def test_open_directions_do_not_lead_the_search_away():
    """A half-space below an optical thickness of 3: a correction along the direction that its values leave open once
    ended in a corner of the ranges."""
    def layers(tau, albedo, g):
        return [Medium(albedo=1.0, tau=tau, phase=HenyeyGreenstein(0.5)),
                Medium(albedo=albedo, tau=1.0, phase=HenyeyGreenstein(g))]
    rng = np.random.default_rng(4)
    solved = lamina.solve(Stack(layers(2.434, 0.884, -0.099), lamina.HalfSpace(albedo=0.972)))
    mu_o, mu_i, dphi = rng.uniform(0.1, 1.0, 30), rng.uniform(0.1, 1.0, 30), rng.uniform(0.0, np.pi, 30)
    values = solved.brdf(mu_o, mu_i, dphi)[:, 0] * (1.0 + 0.02 * rng.standard_normal(30))
    fit = lamina.fit(
        Brdf(values=values, relative=0.02, mu_o=mu_o, mu_i=mu_i, dphi=dphi),
        Template(layers(Free(0.556, 0.05, 30.0), Free(0.59, 0.1, 1.0), Free(0.567, -0.9, 0.96)),
                 lamina.HalfSpace(albedo=Free(0.936, 0.1, 1.0))))
    assert fit.probability > LEVEL
    assert any("cannot tell" in one or "do not determine" in one or "hardly tell" in one for one in fit.remarks)


def test_a_second_search_leaves_a_bad_start():
    """Ranges of many decades, from a start at which the unscattered light says nothing."""
    solved = lamina.solve(Stack([Medium(sigma_s=5.0, sigma_a=0.1, thickness=1.0, phase=HenyeyGreenstein(0.9))]))
    measured = [Reflectance(values=solved.reflectance(1.0), relative=1e-3, mu_i=1.0),
                Transmittance(values=solved.transmittance(1.0), relative=1e-3, mu_i=1.0),
                Transmittance(values=solved.transmittance(1.0, parts=True)[1], relative=1e-3, mu_i=1.0, part="direct")]
    fit = lamina.fit(measured, Template([Medium(
        sigma_s=Free(190.0, 0.01, 200.0, "s"), sigma_a=Free(15.0, 0.0, 20.0, "a"), thickness=1.0,
        phase=HenyeyGreenstein(Free(-0.4, -0.5, 0.95, "g")))]))
    assert list(fit.values.values()) == pytest.approx([0.9, 5.0, 0.1], rel=2e-3), fit


LOW, HIGH = [[0.1], [0.1], [0.0]], [[1.0], [1.0], [np.pi]]  # of both cosines and the azimuth


def test_a_second_search_leaves_a_corner():
    """The first search ends with a thickness of 8 over a black base, with a probability of .7 %."""
    random = np.random.default_rng(9)
    for _ in range(24):
        albedo, base = random.uniform(0.3, 0.98, 2)
        tau, g = random.uniform(0.2, 3.0), random.uniform(-0.3, 0.8)
        places = dict(zip(("mu_o", "mu_i", "dphi"), random.uniform(LOW, HIGH, (3, 60)), strict=True))
        noise = random.standard_normal((60, 1))
    exact = lamina.solve(Stack(slab(albedo, g, tau), Lambert(base))).brdf(**places)
    measured = Brdf(values=exact * (1.0 + 0.01 * noise), relative=0.01, **places)
    free = slab(Free(0.1, 0.0, 1.0), Free(-0.4, -0.5, 0.95), Free(10.0, 0.05, 20.0, "tau"))
    fit = lamina.fit(measured, Template(free, Lambert(Free(0.05, 0.0, 1.0))))
    assert fit.chi_squared <= np.sum(noise**2) and abs(fit.values["tau"] - tau) < 4.0 * fit.errors["tau"]


def test_the_end_of_a_range_is_named():
    solved = lamina.solve(Stack(slab(0.9, 0.0, 1.0)))
    mu = np.array([0.2, 0.5, 0.9])
    fit = lamina.fit(Reflectance(values=solved.reflectance(mu), sigma=1e-3, mu_i=mu),
                     Template(slab(Free(0.3, 0.0, 0.5, "albedo"), 0.0, 1.0)))
    assert fit.values["albedo"] == pytest.approx(0.5, abs=1e-4)
    assert "albedo lies at the end of its range, 0.5" in fit.remarks[0]


def test_measurements_may_differ_from_the_template():
    """A film over black and white, and in two thicknesses, one of which is free too."""
    def film(sigma_s, sigma_a, thickness):
        return [lamina.Interface(1.5), Medium(sigma_s=sigma_s, sigma_a=sigma_a, thickness=thickness)]
    measured = []
    second = Free(0.2, 0.01, 1.0, "second thickness")
    for base, thickness, given in ((0.05, 0.05, 0.05), (0.85, 0.05, 0.05), (0.05, 0.12, second)):
        solved = lamina.solve(Stack(film(60.0, 4.0, thickness), Lambert(base)))
        measured.append(Reflectance(values=solved.reflectance([0.5, 1.0]), sigma=1e-4, mu_i=[0.5, 1.0], changes={
            "base": Lambert(base), "layers[1].thickness": given}))
    fit = lamina.fit(measured, Template(film(Free(20.0, 1.0, 500.0), Free(1.0, 0.0, 100.0), 1.0), Lambert(0.5)))
    assert list(fit.values.values()) == pytest.approx([60.0, 4.0, 0.12], rel=1e-3)
    assert fit.stack.base == Lambert(0.5)


def test_profiles_over_distance():
    """Coefficients per millimetre from the light beside a beam; exact values, so only the errors of tables remain."""
    r = np.geomspace(0.3, 6.0, 8)
    def body(sigma_s, sigma_a):
        return [lamina.Interface(1.4)], lamina.HalfSpace(sigma_s=sigma_s, sigma_a=sigma_a)
    beam = lamina.searchlight(Stack(*body(2.0, 0.05)))
    fit = lamina.fit(Profile(values=beam.profile(r), relative=0.03, r=r),
                     Template(*body(Free(1.0, 0.1, 20.0, "s"), Free(0.2, 0.001, 5.0, "a"))))
    assert abs(fit.values["s"] - 2.0) < 0.1 * fit.errors["s"] < 0.01
    assert abs(fit.values["a"] - 0.05) < 0.1 * fit.errors["a"] < 0.001


def test_any_number_of_threads_gives_the_same():
    _, measured = noisy_case(1, count=40)
    one, two = (lamina.fit(measured, free_slab(), threads=threads) for threads in (1, 2))
    assert one.values == two.values and one.errors == two.errors


def test_equal_channels_share_their_solution():
    """A step of one channel's albedo leaves the other channels alone."""
    solved = lamina.solve(Stack(slab([0.9, 0.7, 0.5], 0.3, 1.0)))
    mu = np.array([0.2, 0.5, 0.9])
    measured = Reflectance(values=solved.reflectance(mu), sigma=1e-3, mu_i=mu)
    three = lamina.fit(measured, Template(slab([Free(0.8, 0, 1), Free(0.6, 0, 1), Free(0.4, 0, 1)], 0.3, 1.0)))
    alone = [lamina.fit(Reflectance(values=solved.reflectance(mu)[:, c], sigma=1e-3, mu_i=mu),
                        Template(slab(Free(start, 0, 1), 0.3, 1.0))) for c, start in enumerate((0.8, 0.6, 0.4))]
    assert three.solves <= 1.5 * sum(one.solves for one in alone)


def test_progress_and_cancel():
    _, measured = noisy_case(2, count=20)
    seen = []
    lamina.fit(measured, free_slab(), progress=lambda share, text: seen.append((share, text)))
    shares = [share for share, _ in seen]
    assert shares == sorted(shares) and shares[0] >= 0.0 and shares[-1] == 1.0 and len(set(shares)) > 3
    assert any(text.startswith("Chi-squared") for _, text in seen)
    calls = iter(range(100))
    with pytest.raises(lamina.Cancelled, match="the fit was cancelled"):
        lamina.fit(measured, free_slab(), cancel=lambda: next(calls) > 2)


def test_without_scipy(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    with pytest.raises(lamina.ExtraMissing, match="lamina.fit needs scipy, which is not installed: pip install scipy"):
        lamina.fit([], free_slab())


def test_facets_that_the_solver_takes_as_mirrors_are_refused():
    """lamina.solve gives such a base the energy of its facets, which a fit does not."""
    measured = Reflectance(values=0.5, sigma=0.1, mu_i="diffuse")
    template = Template([], lamina.PrincipledBase(color=Free(0.5, 0.0, 1.0), roughness=0.1))
    with pytest.raises(lamina.StackError, match="base.roughness = 0.1: must be 0, or at least 0.174 in a fit"):
        lamina.fit(measured, template)


def test_profiles_need_lengths():
    with pytest.raises(lamina.StackError, match=r"layers\[0\]: has no lengths"):
        lamina.fit(Profile(values=[0.1] * 3, sigma=0.1, r=[1.0, 2.0, 3.0]), free_slab())


def test_results_can_be_pickled():
    _, measured = noisy_case(3, count=20)
    fit = lamina.fit(measured, free_slab())
    again = pickle.loads(pickle.dumps(fit))
    assert again.values == fit.values and again.stack == fit.stack and repr(again) == repr(fit)


@pytest.mark.parametrize(("given", "template", "message"), [
    ([], None, r"measurements = \[\]: must be a measurement"),
    ([1], None, r"measurements\[0\] = 1: must be one of the classes of lamina.measurements"),
    (Reflectance(values=[0.1, 0.2, 0.3], sigma=0.1, mu_i="diffuse"), None, r"measurements\[0\].values have 3 channel"),
    (Reflectance(values=0.1, sigma=0.1, mu_i=1.0), None, r"measurements hold 1 value\(s\): must hold at least"),
    (Reflectance(values=[0.1] * 3, sigma=0.1, mu_i=[1.0] * 3, changes={"layers[4].tau": 1.0}), None,
     r"changes\['layers\[4\].tau'\]: the template has 1 layers"),
    (Reflectance(values=0.1, sigma=0.1, mu_i=1.0), Template(slab(0.5, 0.0, 1.0)), "must have a free parameter"),
    (Reflectance(values=0.1, sigma=0.1, mu_i=1.0), Stack(slab(0.5, 0.0, 1.0)), "must be a lamina.Template"),
])
def test_what_does_not_fit_together(given, template, message):
    with pytest.raises(lamina.ArgumentError, match=message):
        lamina.fit(given, template or free_slab())


