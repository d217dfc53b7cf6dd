# SPDX-License-Identifier: GPL-3.0-or-later
"""All ways to compute a value give the same value, in the documented shapes, on any number of threads."""

import math

import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Lambert, Medium, Stack

MU = np.array([0.05, 0.11, 0.3, 0.62, 0.9, 1.0])
DPHI = np.array([0.0, 0.2, 1.5, math.pi])
STACKS = {
    "slab": Stack([Medium(albedo=0.9, tau=2.0, phase=HenyeyGreenstein(0.75))]),
    "rgb on Lambert": Stack([Medium(albedo=[0.9, 0.3, 1.0], tau=[0.01, 1.0, 5.0], phase=HenyeyGreenstein(0.6)),
                             Medium(albedo=0.95, tau=1.0)], base=Lambert([0.8, 0.2, 0.5])),
    "thin backward sheet": Stack([Medium(albedo=0.9, tau=0.01, phase=HenyeyGreenstein(-0.5))]),
    "sharp": Stack([Medium(albedo=0.99, tau=1.0, phase=HenyeyGreenstein(0.9))]),
}
LOOKS = [(*look, side) for side in ("top", "bottom") for look in (("brdf", "reflect"), ("btdf", "transmit"))]


@pytest.fixture(scope="module", params=STACKS)
def solved(request):
    return lamina.solve(STACKS[request.param])


@pytest.mark.parametrize("look, path, side", LOOKS)
class TestAgreement:
    def test_points_are_the_grid(self, solved, look, path, side):
        points = getattr(solved, look)(MU[:, None, None], MU[None, :, None], DPHI, side=side)
        assert points == pytest.approx(solved.grid(path, MU, MU, DPHI, side=side), rel=1e-11, abs=1e-16)

    def test_one_point_is_one_of_many(self, solved, look, path, side):
        grid = solved.grid(path, MU, MU, DPHI, side=side)
        alone = getattr(solved, look)(float(MU[1]), float(MU[3]), float(DPHI[2]), side=side)
        assert alone == pytest.approx(grid[1, 3, 2], rel=1e-11, abs=1e-16)

    def test_long_lists_are_interpolated_as_well(self, solved, look, path, side):
        # More cosines than the lookup solves for: the values are interpolated from a table in the angle.
        o, i, p = (a.ravel() for a in np.meshgrid(MU, MU, DPHI, indexing="ij"))
        more = np.linspace(0.05, 1.0, 500)
        many = getattr(solved, look)(np.r_[o, more], np.r_[i, more[::-1]], np.r_[p, 0.0 * more], side=side)[: o.size]
        few = solved.grid(path, MU, MU, DPHI, side=side).reshape(many.shape)
        assert many == pytest.approx(few, rel=5e-5, abs=1e-15)


def test_very_long_lists_cost_no_more_memory_than_their_values():
    """Each point has its own cosines: joining all of them with each other would take 26 GB."""
    random = np.random.default_rng(3)
    o, i, p = random.uniform(0.05, 1.0, 20000), random.uniform(0.05, 1.0, 20000), random.uniform(0.0, 6.0, 20000)
    solved = lamina.solve(STACKS["rgb on Lambert"])
    assert solved.brdf(o, i, p)[:20] == pytest.approx(solved.brdf(o[:20], i[:20], p[:20]), rel=5e-5)


def test_shapes():
    rgb, grey = lamina.solve(STACKS["rgb on Lambert"]), lamina.solve(STACKS["slab"])
    for solved, channels in ((rgb, 3), (grey, 1)):
        assert solved.brdf(0.5, 0.5, 0.0).shape == (channels,)
        assert solved.btdf(MU, 0.5, 0.0).shape == (6, channels)
        assert solved.brdf(MU[:, None, None], MU[None, :, None], DPHI).shape == (6, 6, 4, channels)
        assert solved.brdf(np.empty((0, 3)) + 0.5, 0.5, 0.0).shape == (0, 3, channels)
        assert solved.grid("reflect", MU, 0.5, DPHI).shape == (6, 1, 4, channels)
        assert solved.reflectance(0.5).shape == (channels,)
        assert solved.reflectance(MU.reshape(2, 3)).shape == (2, 3, channels)
        assert solved.absorption(MU).shape == (6, channels)
        assert solved.transmittance("diffuse").shape == (channels,)
        diffuse, direct = solved.transmittance(MU, parts=True)
        assert diffuse.shape == direct.shape == (6, channels)
        assert np.array_equal(diffuse + direct, solved.transmittance(MU))
    with pytest.raises(ValueError):
        grey.brdf([0.1, 0.2], [0.1, 0.2, 0.3], 0.0)


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_the_same_bytes_on_one_thread_and_on_two(stack):
    one, two = (lamina.solve(stack, threads=threads) for threads in (1, 2))
    long = np.linspace(0.05, 1.0, 3000)
    for path in ("reflect", "transmit"):
        assert one.grid(path, MU, MU, DPHI).tobytes() == two.grid(path, MU, MU, DPHI).tobytes()
    assert one.brdf(MU, MU, 0.3).tobytes() == two.brdf(MU, MU, 0.3).tobytes()
    assert one.brdf(long, long[::-1], long).tobytes() == two.brdf(long, long[::-1], long).tobytes()
    assert one.reflectance(MU).tobytes() == two.reflectance(MU).tobytes()
    assert one.transmittance("diffuse").tobytes() == two.transmittance("diffuse").tobytes()
    assert (one.nodes, one.orders, one.checks) == (two.nodes, two.orders, two.checks)


def test_channels_do_not_know_of_each_other():
    def stack(albedo, tau):
        return Stack([Medium(albedo=albedo, tau=tau, phase=HenyeyGreenstein(0.6))], base=Lambert(0.4))

    together = lamina.solve(stack([0.9, 0.2, 0.9], [1.0, 3.0, 1.0])).grid("reflect", MU, MU, DPHI)
    assert together[..., 0].tobytes() == together[..., 2].tobytes()
    for channel, (albedo, tau) in enumerate([(0.9, 1.0), (0.2, 3.0)]):
        alone = lamina.solve(stack(albedo, tau)).grid("reflect", MU, MU, DPHI)
        assert alone[..., 0].tobytes() == np.ascontiguousarray(together[..., channel]).tobytes()


def test_another_thickness_is_a_new_solve():
    stack = STACKS["rgb on Lambert"]
    quick = lamina.solve(stack).with_thickness(1, [0.0, 0.3, 20.0])
    layers = [stack.layers[0], Medium(albedo=0.95, tau=[0.0, 0.3, 20.0])]
    fresh = lamina.solve(Stack(layers, stack.base))
    assert quick.grid("reflect", MU, MU, DPHI) == pytest.approx(fresh.grid("reflect", MU, MU, DPHI), rel=1e-3)
    assert quick.reflectance("diffuse") == pytest.approx(fresh.reflectance("diffuse"), abs=1e-6)


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_preview_keeps_its_promise(stack):
    final, preview = lamina.solve(stack, "final"), lamina.solve(stack, "preview")
    mu = np.array([0.05, 0.0625, 0.1, 0.4, 0.8, 1.0])
    for path in ("reflect", "transmit"):
        truth = final.grid(path, mu, mu, DPHI)
        assert preview.grid(path, mu, mu, DPHI) == pytest.approx(truth, rel=1e-2, abs=1e-15), path


class TestOnePairUnderARoughBoundary:
    """Read from a table that the solution keeps."""

    STACK = Stack([lamina.Interface(1.5, 0.2), Medium(albedo=0.9, tau=[1.0, 0.4], phase=HenyeyGreenstein(0.6))],
                  base=Lambert(0.5))

    def test_is_one_of_many(self):
        solved = lamina.solve(self.STACK)
        random = np.random.default_rng(4)
        points = np.column_stack([random.uniform(0.05, 1.0, (20, 2)), random.uniform(0.0, 6.0, 20)])
        many = solved.brdf(*points.T)
        assert np.array([solved.brdf(*point) for point in points]) == pytest.approx(many, rel=1e-4)
        alone = lamina.solve(self.STACK).brdf(*points[3])
        assert solved.brdf(*points[3]).tobytes() == alone.tobytes(), "values must not depend on earlier calls"

    def test_belongs_to_its_own_solution(self):
        solved = lamina.solve(self.STACK)
        for other in (solved.with_base_reflectance(0.1), solved.with_thickness(1, [0.0, 3.0])):
            solved.brdf(0.5, 0.7, 1.0)  # makes the table of the first solution
            assert other.brdf(0.5, 0.7, 1.0) == pytest.approx(other.brdf([0.5, 0.4], 0.7, 1.0)[0], rel=1e-4)
            assert np.abs(other.brdf(0.5, 0.7, 1.0) / solved.brdf(0.5, 0.7, 1.0) - 1.0).min() > 0.01
