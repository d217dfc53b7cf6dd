# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks in meshes against the solver, the searchlight, and each other."""

import numpy as np
import pytest
from walk_meshes import box, slab, sphere, view
from z_limit import z_limit

import lamina
from lamina import EndMaterial, Interior, Lamp, Surface, Surroundings
from lamina.common.progress import silent
from lamina.interior.problem import Problem, Samples, WalkPoints
from lamina.interior.walk import Walker
from lamina.subsurface.entry_cosines import mean_entry_cosines
from lamina.subsurface.node_parameters import LEAST_IOR
from lamina.subsurface.response_table import response_curves

SIGMA_S = (0.9, 1.6, 0.4)
SIGMA_A = (0.1, 0.05, 0.3)
G = 0.6
THICKNESS = 2.0
PHASE = lamina.HenyeyGreenstein(G)
SURFACES = {"matched": Surface(), "smooth": Surface(1.4), "rough": Surface(1.4, 0.3),
            "beckmann": Surface(1.4, 0.3, "beckmann")}


def stack(surface=None, sigma_s=SIGMA_S, sigma_a=SIGMA_A, phase=PHASE, thickness=THICKNESS):
    """The plane stack equivalent to a slab."""
    medium = lamina.Medium(sigma_s=sigma_s, sigma_a=sigma_a, thickness=thickness, phase=phase)
    if surface is None or surface.ior == 1.0:
        return lamina.Stack([medium])
    top, bottom = (lamina.Interface(ior=ior, alpha=surface.alpha, distribution=surface.distribution)
                   for ior in (surface.ior, 1.0))
    return lamina.Stack([top, medium, bottom])


def require_within_error(difference, stderr, cases=1):
    """`cases`: number of parameters of the test, which are one family."""
    z = np.ravel(difference) / np.ravel(stderr)
    assert np.abs(z).max() < z_limit(z.size * cases), z


@pytest.mark.parametrize("name", SURFACES)
def test_a_wide_slab_is_a_plane_stack(name):
    """Exit albedo for light from one direction, compared with the solver."""
    surface, mu, samples = SURFACES[name], 0.7, 60000
    found = lamina.walk_in_mesh(*walk_slab(EndMaterial(SIGMA_S, SIGMA_A, G)), view(mu), surface, samples, seed=5)
    solved = lamina.solve(stack(surface))
    expected = solved.reflectance(mu) + solved.transmittance(mu)
    mirrored = found.mirrored[0]
    # Facets reflect some walks entirely, the three walks of a sample alike, which adds to the variance.
    variance = mirrored * (1.0 - mirrored) / samples if surface.alpha else 0.0
    require_within_error(found.albedo.value[0] + mirrored - expected, np.sqrt(found.albedo.stderr[0]**2 + variance),
                         len(SURFACES))
    assert found.count.lost == 0.0


def walk_slab(material, thickness=THICKNESS):
    """The first arguments of a walk in a homogeneous slab."""
    solid, points, normals = slab(thickness)
    return solid, Interior.uniform(material), points, normals


def test_light_of_a_sky_on_a_wide_slab():
    """Cosine-distributed entry."""
    found = lamina.walk_in_mesh(*walk_slab(EndMaterial(SIGMA_S, SIGMA_A, G)), samples=60000, seed=2)
    solved = lamina.solve(stack())
    expected = solved.reflectance("diffuse") + solved.transmittance("diffuse")
    require_within_error(found.albedo.value[0] - expected, found.albedo.stderr[0])


@pytest.mark.parametrize("mu", [1.0, 0.5])
def test_distances_are_those_of_the_searchlight(mu):
    """A slab so thick that no light passes."""
    material = EndMaterial(0.9, 0.1, 0.3)
    found = lamina.walk_in_mesh(*walk_slab(material, 40.0), view(mu), samples=60000, seed=3)
    medium = lamina.HalfSpace(sigma_s=0.9, sigma_a=0.1, phase=lamina.HenyeyGreenstein(0.3))
    beam = lamina.searchlight(lamina.Stack([], base=medium), mu, quality="preview")
    pairs = [(found.albedo, beam.reflectance), (found.mean_distance, beam.mean_distance),
             (found.mean_square_distance, beam.mean_square_distance)]
    require_within_error([one.value[0, 0] - expected[0] for one, expected in pairs],
                         [one.stderr[0, 0] for one, _ in pairs])


@pytest.mark.parametrize("surface", [Surface(), Surface(1.5), Surface(1.5, 0.4)])
def test_a_sphere_that_absorbs_nothing_returns_all_light(surface):
    """A sphere of ten mean free paths; walks start at vertices and inside faces."""
    solid = sphere(5.0)
    corners = solid.vertices[solid.triangles[:3]]
    inside = corners.mean(axis=1)
    points = np.vstack([solid.vertices[:3], inside])
    normals = np.vstack([solid.vertices[:3], inside])
    samples = 3000
    found = lamina.walk_in_mesh(solid, Interior.uniform(EndMaterial((1.0, 0.5, 2.0), 0.0, 0.5)), points, normals,
                                surface=surface, samples=samples, seed=4)
    mirrored = found.mirrored[:, None]
    assert found.count.lost < 1e-4
    lost = 3 * len(points) * found.count.lost  # at most this much in one channel of one point
    if surface.alpha == 0.0:  # no path is absorbed or reflected at its start
        # The only noise is that of roulette: .5 % of the paths enter so grazing that their weight is below .25, where
        # roulette adds a variance of at most .25^2.
        roulette = 4.0 * np.sqrt(0.005 * 0.25**2 / samples)
        np.testing.assert_allclose(found.albedo.value.mean(axis=1) + found.mirrored, 1.0, atol=roulette + lost)
    if surface.ior == 1.0:
        np.testing.assert_allclose(found.albedo.value, 1.0, atol=1e-9 + lost)
        return
    variance = mirrored * (1.0 - mirrored) / samples  # the walks of a sample are reflected alike
    require_within_error(found.albedo.value + mirrored - 1.0, np.sqrt(found.albedo.stderr**2 + variance))


def test_channels_with_unequal_extinctions_are_as_precise_as_grey_ones():
    """The standard error of each channel of a bright ball, compared with a ball that has this channel's coefficients in
    all channels. One path for all channels had errors 5 to 10 times as large."""
    solid, scattering, absorption = sphere(5.0), (2.0, 3.0, 4.0), (0.002, 0.004, 0.008)
    points = solid.vertices[:4]

    def noise(sigma_s, sigma_a):
        return lamina.walk_in_mesh(solid, Interior.uniform(EndMaterial(sigma_s, sigma_a)), points, points / 5.0,
                                   samples=2000, seed=6).albedo.stderr

    coloured = noise(scattering, absorption)
    for c in range(3):
        grey = noise(scattering[c], absorption[c])[:, c]  # each sample has three paths for this channel
        assert (coloured[:, c] < 1.3 * np.sqrt(3.0) * grey).all(), (c, coloured[:, c], grey)


def test_layers_as_voxels_are_the_stack_of_layers():
    """Three layers of four voxels each, with constant coefficients per voxel."""
    layers = [((0.9, 0.5, 1.5), 0.05, 1.0), (0.2, (0.4, 0.1, 0.0), 1.0), (2.0, 0.01, 1.0)]
    arrays = [np.array([np.broadcast_to(layer[k], 3) for layer in reversed(layers)]) for k in (0, 1)]
    sigma_s, sigma_a = (np.broadcast_to(np.repeat(array, 4, axis=0), (5, 3, 12, 3)) for array in arrays)
    solid, points, normals = slab(3.0)
    interior = Interior.of_coefficients(sigma_s, sigma_a, solid.vertices.min(axis=0), solid.vertices.max(axis=0), 0.4,
                                        smooth=False)
    found = lamina.walk_in_mesh(solid, interior, points, normals, view(0.6), samples=60000, seed=5)
    phase = lamina.HenyeyGreenstein(0.4)
    solved = lamina.solve(lamina.Stack([lamina.Medium(sigma_s=s, sigma_a=a, thickness=d, phase=phase)
                                        for s, a, d in layers]))
    expected = solved.reflectance(0.6) + solved.transmittance(0.6)
    require_within_error(found.albedo.value[0] - expected, found.albedo.stderr[0])


def test_a_smooth_grid_is_linear_between_voxel_centres():
    """Compared with a medium with a profile: coefficients are linear in depth between knots."""
    ends = ((2.0, 0.02), (0.2, 0.3))  # (sigma_s, sigma_a) of the upper and the lower voxel
    solid, points, normals = slab(THICKNESS)
    sigma_s, sigma_a = (np.array([ends[1][k], ends[0][k]]).reshape(1, 1, 2) for k in (0, 1))
    interior = Interior.of_coefficients(sigma_s, sigma_a, solid.vertices.min(axis=0), solid.vertices.max(axis=0), G)
    found = lamina.walk_in_mesh(solid, interior, points, normals, view(0.8), samples=60000, seed=6)
    quarter = [lamina.Medium(sigma_s=s, sigma_a=a, thickness=0.25 * THICKNESS, phase=PHASE) for s, a in ends]
    count = 60
    share = (np.arange(count) + 0.5) / count
    middle = [lamina.Medium(sigma_s=s, sigma_a=a, thickness=0.5 * THICKNESS / count, phase=PHASE)
              for s, a in zip(*((1.0 - share) * ends[0][k] + share * ends[1][k] for k in (0, 1)), strict=True)]
    solved = lamina.solve(lamina.Stack([quarter[0], *middle, quarter[1]]))
    expected = solved.reflectance(0.8) + solved.transmittance(0.8)
    require_within_error(found.albedo.value[0, :1] - expected, found.albedo.stderr[0, :1])
    places = [[0.0, 0.0, -z] for z in (0.2, 0.5, 1.0, 1.5, 1.9)]
    assert interior.at(places)[0][:, 0] == pytest.approx([2.0, 2.0, 1.1, 0.2, 0.2], rel=1e-3)


def test_end_materials_mix_with_both_phase_functions():
    """A mixture coordinate between two of the three materials of a palette."""
    materials = [EndMaterial(5.0), EndMaterial((1.0, 0.5, 0.2), 0.1, 0.8), EndMaterial((0.3, 0.9, 0.6), 0.02, -0.3)]
    share = (1.0 / 3.0, 2.0 / 3.0)
    solid, points, normals = slab(THICKNESS)
    interior = Interior.mixed(np.full((2, 2, 2), 0.5 + share[0] / 2.0), materials, (0, 0, 0), (1, 1, 1))
    found = lamina.walk_in_mesh(solid, interior, points, normals, view(0.7), samples=60000, seed=7)
    expected = []
    for c in range(3):
        of = [w * one.sigma_s[c] for w, one in zip(share[::-1], materials[1:], strict=True)]
        absorbed = sum(w * one.sigma_a[c] for w, one in zip(share[::-1], materials[1:], strict=True))
        phase = lamina.Mixture([(of[0] / sum(of), lamina.HenyeyGreenstein(0.8)),
                                (of[1] / sum(of), lamina.HenyeyGreenstein(-0.3))])
        solved = lamina.solve(stack(None, sum(of), absorbed, phase))
        expected.append((solved.reflectance(0.7) + solved.transmittance(0.7))[0])
    require_within_error(found.albedo.value[0] - expected, found.albedo.stderr[0])


def test_one_path_for_three_channels_is_three_runs():
    """A heterogeneous sphere whose channels differ by a factor of eight."""
    rng = np.random.default_rng(1)
    sigma_s = rng.uniform(0.1, 1.0, (9, 10, 11, 1)) * [1.0, 3.0, 8.0]
    sigma_a = rng.uniform(0.0, 0.1, (9, 10, 11, 1)) * [8.0, 1.0, 0.1]
    solid = sphere(1.0, 3)
    corners = solid.vertices.min(axis=0), solid.vertices.max(axis=0)
    points, normals = solid.vertices[:1], solid.vertices[:1]

    def run(s, a, seed):
        return lamina.walk_in_mesh(solid, Interior.of_coefficients(s, a, *corners, 0.5), points, normals,
                                   surface=Surface(1.3), samples=40000, seed=seed)

    together = run(sigma_s, sigma_a, 8)
    differences, errors = [], []
    for c in range(3):
        alone = run(sigma_s[..., c], sigma_a[..., c], 9 + c)
        for one, other in ((together.albedo, alone.albedo), (together.mean_distance, alone.mean_distance)):
            differences.append(one.value[0, c] - other.value[0, 0])
            errors.append(np.hypot(one.stderr[0, c], other.stderr[0, 0]))
    require_within_error(differences, errors)


@pytest.mark.parametrize("surface", [Surface(), Surface(1.4, 0.4)])
def test_the_light_of_a_lamp_is_the_brdf(surface):
    """Radiance from one lamp, also with view and light exchanged, without the reflection of facets at the top."""
    directions = [view(0.8), [-0.6, 0.0, 0.8], [0.0, 0.866, 0.5]]
    solid, points, normals = slab(THICKNESS)
    interior = Interior.uniform(EndMaterial(SIGMA_S, SIGMA_A, G))
    solved = lamina.solve(stack(surface))
    facets = lamina.solve(stack(surface, 0.0, 1e4)) if surface.alpha else None
    differences, errors = [], []
    for v, lit in ((0, 2), (2, 0), (0, 1)):
        found = lamina.light_in_mesh(solid, interior, [Lamp(directions[lit])], points, normals, directions[v], surface,
                                     20000, seed=20 + v)
        out, towards = np.array(directions[v]), np.array(directions[lit])
        azimuth = np.arctan2(out[1], out[0]) - np.arctan2(-towards[1], -towards[0])
        expected = solved.brdf(out[2], towards[2], azimuth) * towards[2]
        if facets is not None:
            expected = expected - facets.brdf(out[2], towards[2], azimuth) * towards[2]
        differences.append(found.lamps.value[0, 0] - np.ravel(expected))
        errors.append(found.lamps.stderr[0, 0])
    require_within_error(differences, errors)


def test_the_light_of_a_sky_is_the_albedo_of_a_convex_solid():
    solid = sphere(1.0, 3)
    where = (solid.vertices[:1], solid.vertices[:1], [0.1, 0.2, 1.0])
    interior = Interior.uniform(EndMaterial(SIGMA_S, SIGMA_A, G))
    sky = lamina.light_in_mesh(solid, interior, [], *where[:2], samples=20000, seed=1).sky
    albedo = lamina.walk_in_mesh(solid, interior, *where[:2], samples=20000, seed=2).albedo
    require_within_error(sky.value - albedo.value, np.hypot(sky.stderr, albedo.stderr))


def test_a_disc_behind_a_smooth_boundary():
    """Compared with the BRDF minus the reflection of a black slab, integrated over the disc."""
    solid, points, normals = slab(THICKNESS)
    interior = Interior.uniform(EndMaterial(SIGMA_S, SIGMA_A, G))
    found = lamina.light_in_mesh(solid, interior, [Lamp(view(0.8), 0.3)], points, normals, view(0.9), Surface(1.4),
                                 60000, seed=3)
    nodes, weights = np.polynomial.legendre.leggauss(6)
    cosine = (1.0 - (1.0 - np.cos(0.3)) * 0.5 * (nodes + 1.0))[:, None]
    turn = 2.0 * np.pi * (np.arange(12) + 0.5) / 12
    x, _, z = view(0.8)
    sine = np.sqrt(1.0 - cosine * cosine)
    # Angles about the lamp's axis, in the plane of incidence and perpendicular to this plane.
    ways = [cosine * x - sine * np.cos(turn) * z, sine * np.sin(turn), cosine * z + sine * np.cos(turn) * x]
    azimuth = -np.arctan2(-ways[1], -ways[0])
    whole, black = (lamina.solve(one).brdf(0.9, ways[2], azimuth)
                    for one in (stack(Surface(1.4)), stack(Surface(1.4), 0.0, 1e4)))
    radiance = ((whole - black) * ways[2][..., None]).mean(axis=1)
    expected = np.einsum("k,kc->c", 0.5 * weights, radiance) * 2.0 / (1.0 + np.cos(0.3))
    require_within_error(found.lamps.value[0, 0] - expected, found.lamps.stderr[0, 0])


@pytest.mark.parametrize("surface", [Surface(), Surface(1.3, 0.5), Surface(1.5)])
def test_moments_are_those_of_light_in_given_directions(surface):
    """Means over directions that are cosine-distributed about the normal."""
    solid, rng = sphere(2.0, 3), np.random.default_rng(5)
    interior = Interior.uniform(EndMaterial((1.0, 1.5, 2.0), 0.2, 0.5))
    places = np.array([[2.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, -2.0, 0.0]])
    lit_by = {"lamps": [Lamp((1.0, 1.0, -0.3), 0.2)], "surface": surface,
              "surroundings": Surroundings(np.linspace(0.0, 3.0, 12).reshape(2, 2, 3))}
    found = lamina.light_in_mesh(solid, interior, points=places, normals=places, samples=30_000, **lit_by)
    moments = [found.lamp_moments.value[:, 0], found.sky_moments.value]
    errors = [found.lamp_moments.stderr[:, 0], found.sky_moments.stderr]
    for k, place in enumerate(places):
        normal = place / np.linalg.norm(place)
        up = np.sqrt(rng.random((2000, 1)))
        across = rng.normal(size=(2000, 3))
        across -= (across @ normal)[:, None] * normal
        w = up * normal + np.sqrt(1.0 - up**2) * across / np.linalg.norm(across, axis=1, keepdims=True)
        seen = lamina.light_in_mesh(solid, interior, points=np.broadcast_to(place, w.shape),
                                    normals=np.broadcast_to(place, w.shape), directions=w, samples=8, **lit_by)
        x, y, z = w.T
        terms = np.column_stack([w, x * x, y * y, x * y, y * z, z * x])
        for light, moment, error in zip((seen.lamps.value[:, 0], seen.sky.value), moments, errors, strict=True):
            wanted = light.mean(axis=-1, keepdims=True) * terms
            stderr = np.hypot(error[k], wanted.std(axis=0) / np.sqrt(len(w)))
            require_within_error(moment[k] - wanted.mean(axis=0), stderr, 6)
        gray = seen.sky.value.mean(axis=-1, keepdims=True)
        np.testing.assert_allclose(seen.sky_moments.value, gray * terms, atol=1e-12)


@pytest.mark.parametrize("surface", [Surface(), Surface(1.3, 0.5)])
def test_a_lamp_and_the_eye_may_change_places(surface):
    """Reciprocity: the total light of a heterogeneous ball in direction a from a lamp at b equals the light in
    direction b from a lamp at a. This holds for a solid of any shape."""
    rng = np.random.default_rng(4)
    sigma_s = rng.uniform(0.0, 2.0, (3, 3, 3, 3)) * [1.0, 2.0, 4.0]
    solid = sphere(1.0, 2)
    interior = Interior.of_coefficients(sigma_s, 0.1 * sigma_s[::-1], (-1, -1, -1), (1, 1, 1), 0.5)
    corners = solid.vertices[solid.triangles]
    areas = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    ends = np.array([[0.0, 0.6, 0.8], [1.0, 0.0, 0.0]])
    sent, errors = [], []
    for eye, lamp in ((0, 1), (1, 0)):
        seen = areas @ ends[eye]
        faces = seen > 0.0
        found = lamina.light_in_mesh(solid, interior, [Lamp(ends[lamp])], corners[faces].mean(axis=1), areas[faces],
                                     ends[eye], surface, 600, seed=30 + eye).lamps
        sent.append(np.einsum("n,nc->c", seen[faces], found.value[:, 0]))
        errors.append(np.sqrt(np.einsum("n,nc->c", seen[faces]**2, found.stderr[:, 0]**2)))
    assert (np.array(errors) < 0.05 * np.array(sent)).all()
    require_within_error(sent[0] - sent[1], np.hypot(*errors))


@pytest.mark.parametrize(("g", "apart"), [(0.0, 0.03), (0.8, 0.2)])
def test_late_light(g, apart):
    """Light that leaves a deep medium after more scatterings than Cycles' walk has, compared with what that walk loses
    in a half-space according to its table. With transport coefficients its later flights have the length of several.
    `apart`: with the phase function at all orders, not only the first nine, 14 % more light is late at g .8."""
    single = np.array([0.9995, 0.998, 0.99])
    medium = Interior.uniform(EndMaterial(tuple(single), tuple(1.0 - single), g))
    solid, points, normals = box((-1e3, -1e3, -1e3), (1e3, 1e3, 0.0)), [[0.3, -0.2, 0.0]], [[0.0, 0.0, 1.0]]
    samples, runs = 4000, 12
    where = WalkPoints.of(np.repeat(points, runs, axis=0), np.repeat(normals, runs, axis=0))
    walker = Walker(Problem(solid, medium, points=where), 0, silent)
    moments, _, _, late = walker.exits(Samples(samples, 3), silent,
                                       late_after=tuple(9.0 + 246.0 / (1.0 - g * single)))
    curves = response_curves(g, *mean_entry_cosines(LEAST_IOR, 0.0))
    lost = np.interp(-single, -curves.single, curves.full_albedo - curves.albedo)
    found = late[..., 0] / samples
    error = found.std(axis=0, ddof=1) / np.sqrt(runs)
    assert np.all(np.abs(found.mean(axis=0) - lost) < apart * lost + 1e-5 + z_limit(6, degrees=runs - 1) * error)
    assert np.all(late[..., 0] <= moments[..., 0]) and error[0] < 0.05 * lost[0]
    assert not np.any(walker.exits(Samples(samples, 3), silent, range(1))[3])  # by default, no light is late


def test_a_negative_zero_is_a_zero():
    solid, points, normals = box((0, 0, 0), (4, 4, 4)), [[2.0, 2.0, 4.0]], [[0.0, 0.0, 1.0]]
    both = [Interior.of_coefficients(np.ones((2, 2, 2)), np.full((2, 2, 2), zero), (0, 0, 0), (4, 4, 4))
            for zero in (0.0, -0.0)]
    assert both[0].hash == both[1].hash
    for interior in both:
        found = lamina.walk_in_mesh(solid, interior, points=points, normals=normals, samples=64)
        assert np.all(found.albedo.value == 1.0)


def test_vertices_without_faces_do_not_count():
    """They gave the walk a wrong size of the solid, so that it stepped over faces."""
    solid, interior = box((0, 0, 0), (4, 4, 4)), Interior.uniform(EndMaterial(SIGMA_S, SIGMA_A, G))
    more = lamina.Solid(np.vstack([solid.vertices, [[1e8, 0.0, 0.0]]]), solid.triangles)
    found = [lamina.walk_in_mesh(one, interior, points=[[2.0, 2.0, 4.0]], normals=[[0.0, 0.0, 1.0]], samples=500)
             for one in (solid, more)]
    np.testing.assert_array_equal(found[0].albedo.value, found[1].albedo.value)


def test_directions_into_the_solid_are_refused():
    solid, interior = box((0, 0, 0), (4, 4, 4)), Interior.uniform(EndMaterial(SIGMA_S, SIGMA_A, G))
    with pytest.raises(lamina.ArgumentError, match=r"directions\[0\] points into the solid: must point to the eye"):
        lamina.walk_in_mesh(solid, interior, points=[[2.0, 2.0, 4.0]], normals=[[0.0, 0.0, 1.0]],
                            directions=[1.0, 0.0, -0.2])
