"""All states of rest of one body on a hinge under torques that go up and down many times a turn, counted otherwise."""

import math

import numpy as np
import pytest
import rbdyn as rb


def hinge(torque, start=0.5, weight=0.0, spring=None):
    """m g d = `weight`, hanging down at angle 0."""
    scene = rb.Scene(gravity=[0, 0, -weight])
    body = scene.add(rb.RigidBody(1.0, [1, 1, 1], com=[0, 0, -1.0]), rb.Revolute([0, 1, 0]), angle=start)
    scene.apply(rb.JointTorque(torque), body)
    if spring is not None:
        scene.apply(rb.TorsionSpring(spring), body)
    return scene


def places(states):
    return np.array([state.coordinates[0] for state in states])


def on_the_circle(size, wave, phase, other, other_wave, other_phase, weight):
    """Angles where size sin(wave q + phase) + other sin(other_wave q + other_phase) = weight sin q: the zeros on the
    unit circle of the polynomial in z = e^iq that this is, e^(i wave q) times."""
    c = np.zeros(2 * wave + 1, complex)
    for amplitude, k, p in ((size, wave, phase), (other, other_wave, other_phase), (-weight, 1, 0.0)):
        c[wave + k] += amplitude * np.exp(1j * p) / 2j
        c[wave - k] -= amplitude * np.exp(-1j * p) / 2j
    z = np.roots(c[::-1])
    return np.sort(np.angle(z[np.abs(np.abs(z) - 1.0) < 1e-9]))


TORQUES = [
    (0.32751273026170835, 60, 2.7729527522529214, 0.0, 19, 0.0, 0.0016691549789956933),
    (1.0, 60, 0.3, 0.0, 1, 0.0, 0.001),
    (6.697, 17, -0.404, 0.0048, 1, 0.5854, 0.0041),
    (8.775349894753885, 100, 2.1349486887751947, 0.0031214106878745054, 30, -2.4905045633145972, 0.04070279424831162),
    (0.4, 31, 0.2, 1.3, 7, 1.0, 0.9),
]


@pytest.mark.parametrize("start", [0.5, 2.9, -40.0])
@pytest.mark.parametrize("torque", TORQUES)
def test_every_rest_of_a_turn_is_found_from_any_start(torque, start):
    a, k, p, b, m, r, g = torque
    states = rb.equilibria(hinge(lambda t, q, w: a * np.sin(k * q + p) + b * np.sin(m * q + r), start, g))
    known = on_the_circle(*torque)
    assert places(states) == pytest.approx(known, abs=1e-9)
    slopes = a * k * np.cos(k * known + p) + b * m * np.cos(m * known + r) - g * np.cos(known)
    assert [state.stable for state in states] == (slopes < 0).tolist()
    assert all(state.decided for state in states)


@pytest.mark.parametrize("start", [0.5, 2.9])
@pytest.mark.parametrize(("wave", "weight"), [(200, 0.0), (333, 0.1), (1000, 0.1), (5000, 0.3)])
def test_a_quick_torque_that_outdoes_the_weight_has_two_rests_a_wave(wave, weight, start):
    # |weight sin q| < sin 30 deg: every zero is where the torque's slope is more than wave cos 30 deg, one a half wave
    states = rb.equilibria(hinge(lambda t, q, w: np.sin(wave * q + 0.1), start, weight))
    q = places(states)
    assert len(q) == 2 * wave and ((-math.pi < q) & (q <= math.pi)).all() and (np.diff(q) > 2.0 / wave).all()
    assert np.abs(np.sin(wave * q + 0.1) - weight * np.sin(q)).max() < 1e-15 * wave * 8
    assert [s.stable for s in states] == (np.cos(wave * q + 0.1) < 0).tolist() and all(s.decided for s in states)


def rests_on_a_spring(size, wave, phase, spring):
    """How many zeros size sin(wave q + phase) - spring q has: changes of sign between its own extrema, which are where
    cos(wave q + phase) = spring/(size wave)."""
    most = int(wave * (size / spring + 10.0) / (2 * math.pi)) + 2
    turns = 2 * math.pi * np.arange(-most, most + 1)
    angle = math.acos(spring / (size * wave))
    q = np.sort(np.concatenate([(turns + way * angle - phase) / wave for way in (1.0, -1.0)]))
    value = size * np.sin(wave * q + phase) - spring * q
    assert np.abs(value).min() > 1e-9 * size
    return np.count_nonzero(np.diff(np.sign(value)))


@pytest.mark.parametrize(
    ("wave", "size", "spring"), [(100, 6.8, 0.3), (100, 6.8, 0.1), (2000, 1.0, 0.5), (10, 6.8, 0.01)]
)
def test_on_a_soft_torsion_spring_no_rest_is_left_out(wave, size, spring):
    states = rb.equilibria(hinge(lambda t, q, w: size * np.sin(wave * q + 0.27), 0.3, 0.0, spring))
    q = places(states)
    assert len(q) == rests_on_a_spring(size, wave, 0.27, spring)
    assert np.abs(size * np.sin(wave * q + 0.27) - spring * q).max() < 1e-14 * wave * max(1.0, np.abs(q).max())
    assert [state.stable for state in states] == [k % 2 == 0 for k in range(len(q))]


def test_more_than_can_be_kept_is_refused_and_searched_about_a_place():
    def torque(t, q, w):
        return np.sin(2000 * q + 0.27)

    scene = hinge(torque, 0.3, 0.0, 0.001)
    with pytest.raises(rb.InvalidInput, match="more than 40000 Taylor series.*near="):
        rb.equilibria(scene)
    q = places(rb.equilibria(scene, near=[100.0]))
    # sin(2000 q + 0.27) = q/1000, one a half wave: none is left out between the first and the last
    assert q.min() < 99.0 and q.max() > 101.0
    halves = np.rint((2000 * q + 0.27) / math.pi)
    assert (np.diff(halves) == 1).all()
    assert np.abs(np.sin(2000 * q + 0.27) - 0.001 * q).max() < 1e-9
