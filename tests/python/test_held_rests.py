"""States of rest of particles on planes, whose potential along them is written by hand: at any distance, in any length,
whatever the scene is as large as."""

import math

import numpy as np
import pytest
import rbdyn as rb

PLANES = {
    "level": (np.array([0.0, 0.0, 1.0]), np.zeros(3)),
    "across x": (np.array([1.0, 0.0, 2.0]), np.zeros(3)),
    "across y": (np.array([0.0, 0.6, 0.8]), np.zeros(3)),
    "elsewhere": (np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.1, -0.2])),
}


def held(potential, place, normal, point):
    scene = rb.Scene()
    particle = scene.add(rb.Particle(1.0), position=place)
    scene.apply(rb.Potential(lambda r: -potential(r)), particle)
    scene.constrain(rb.PointOnPlane(rb.Plane(normal, point)), particle)
    return scene


def on_plane(x, y, normal, point):
    """The place (x, y, z) on the plane."""
    return [x, y, point[2] - (normal[0] * (x - point[0]) + normal[1] * (y - point[1])) / normal[2]]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("start", [(0.4, 0.3), (3.0, 1.0)])
@pytest.mark.parametrize("plane", PLANES)
def test_a_rest_is_only_where_forces_vanish_however_far_a_search_runs_away(plane, start, sign):
    # cos x + x^2/2 - x^4/24 = 1 - x^6/720 + ..., and y^2: one rest in x, at zero; beyond forces grow as x^3
    normal, point = PLANES[plane]

    def potential(r):
        return sign * (np.cos(r[0]) + r[0] ** 2 / 2 - r[0] ** 4 / 24) + r[1] ** 2

    scene = held(potential, on_plane(*start, normal, point), normal, point)
    for state in rb.equilibria(scene) + rb.equilibria(scene, near=on_plane(*start, normal, point)):
        x, y, _ = state.coordinates
        # the force x^5/120 is no more than the rounding of x, of which it is made
        assert abs(x) < 2e-3
        assert abs(y) < 1e-12
        if state.decided:
            assert state.stable == (sign < 0.0)


@pytest.mark.parametrize("at", [0.9, 2.1])
@pytest.mark.parametrize("length", [1e-3, 1e-9, 1e-10, 1e-12, 1e-15])
@pytest.mark.parametrize("is_held", [False, True])
def test_lengths_far_below_the_scenes_have_rests_of_their_own(is_held, length, at):
    # -length^2 cos(x/length): rests at whole multiples of pi length, in turn stable and not, beside a scene of 1 m
    scene = rb.Scene()
    place = [at * math.pi * length, 0.0, 0.0]
    particle = scene.add(rb.Particle(1.0), position=place)
    other = scene.add(rb.Particle(1.0), position=[0, 1, 0])
    scene.connect(rb.Spring(3.0), other, [0, 1, 0])
    scene.apply(rb.Potential(lambda r: length**2 * np.cos(r[0] / length) - r[1] ** 2 - r[2] ** 2), particle)
    if is_held:
        scene.constrain(rb.PointOnPlane(rb.Plane([0, 0, 1])), particle)
    (state,) = rb.equilibria(scene, near=[*place, 0, 1, 0])
    assert state.coordinates[0] / (math.pi * length) == pytest.approx(round(at), rel=1e-14)
    assert state.decided and state.stable == (round(at) % 2 == 0)
    squares = rb.normal_modes(scene, at=state).squares
    assert np.abs(squares - (1.0 if state.stable else -1.0)).min() < 1e-13


# along one direction of a plane: whether zero is a strict minimum, and its rests
ALONG = {
    "square": (lambda u: u**2 / 2, True),
    "fourth": (lambda u: u**4, True),
    "sixth": (lambda u: u**6, True),
    "fourth, down": (lambda u: -(u**4), False),
    "sixth, down": (lambda u: -(u**6), False),
    "cosine and square": (lambda u: np.cos(u) + u**2 / 2 - 1, True),
    "exponential": (lambda u: np.exp(u) - u, True),
}


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", ALONG)
def test_rests_on_planes_are_where_the_potential_along_them_says(name, seed):
    rng = np.random.default_rng(seed)
    length, force = 10.0 ** rng.uniform(-12, 12), 10.0 ** rng.uniform(-20, 20)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0].T
    far = rng.choice([0.0, 0.0, 1.0, 1e3])
    point = far * length * rng.normal(size=3)
    potential, is_minimum = ALONG[name]

    def field(r):
        u, v, w = (sum(axis[i] * (r[i] - point[i]) for i in range(3)) / length for axis in axes)
        return -force * length * (potential(u) + v**2 / 2 + 0.7 * w)

    start = point + length * (rng.choice([1e-3, 0.1, 1.0]) * rng.normal(size=2)) @ axes[:2]
    scene = rb.Scene()
    particle = scene.add(rb.Particle(10.0 ** rng.uniform(-3, 3)), position=start)
    scene.apply(rb.Potential(field), particle)
    scene.constrain(rb.PointOnPlane(rb.Plane(axes[2], point)), particle)
    for states in rb.equilibria(scene), rb.equilibria(scene, near=start):
        for state in states:
            u, v, w = axes @ (state.coordinates - point) / length
            # beyond rounding of the place, forces that are powers are more than that of their terms
            assert abs(v) < 1e-12 * max(far, 1.0) and abs(w) < 1e-14 * max(far, 1.0)
            assert abs(u) < (1e-12 * max(far, 1.0) if name in ("square", "exponential") else 2e-2)
            assert not state.decided or state.stable == is_minimum
        if is_minimum:
            assert len(states) == 1


AWAY = {
    "exponential": lambda u: np.exp(-u),
    "ramp with waves": lambda u: u + 0.5 * np.sin(u),
    "exponential, up": lambda u: np.exp(u) + 0.1 * u,
}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", AWAY)
def test_where_no_force_vanishes_nothing_rests_however_small_it_is_far_out(name, seed):
    # exp(-u) is rounding of the force that holds the particle on its plane from u = 34 on, and vanishes nowhere
    rng = np.random.default_rng(seed)
    length = 10.0 ** rng.uniform(-9, 9)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0].T
    sign, start = rng.choice([-1.0, 1.0]), length * (rng.uniform(-2, 2, size=2) @ axes[:2])

    def field(r):
        u, v, w = (sum(axis[i] * r[i] for i in range(3)) / length for axis in axes)
        return -length * (sign * AWAY[name](u) + v**2 / 2 + 0.3 * w)

    for is_held in (True, False):
        scene = rb.Scene()
        particle = scene.add(rb.Particle(1.0), position=start)
        if is_held:
            scene.apply(rb.Potential(field), particle)
            scene.constrain(rb.PointOnPlane(rb.Plane(axes[2])), particle)
        else:
            scene.apply(rb.Potential(lambda r: field(r) - r @ (axes[2] / length) * (r @ axes[2]) / 2), particle)
        assert rb.equilibria(scene) == []


@pytest.mark.parametrize("seed", range(3))
def test_a_rest_of_third_order_is_found_whose_force_has_one_sign(seed):
    # e^u - u - u^2/2: its force u^2/2 + ... has the same sign on both sides of its zero
    rng = np.random.default_rng(seed)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0].T
    start = rng.uniform(0.1, 0.4, size=2) @ axes[:2]

    def field(r):
        u, v, w = (sum(axis[i] * r[i] for i in range(3)) for axis in axes)
        return -(np.exp(u) - u - u**2 / 2 + v**2 / 2 + 0.3 * w)

    scene = rb.Scene()
    particle = scene.add(rb.Particle(1.0), position=start)
    scene.apply(rb.Potential(field), particle)
    scene.constrain(rb.PointOnPlane(rb.Plane(axes[2])), particle)
    (state,) = rb.equilibria(scene)
    u, v, _ = axes @ state.coordinates
    assert abs(u) < 1e-6 and abs(v) < 1e-12  # e^u - 1 - u is rounding there
    assert not (state.decided and state.stable)
