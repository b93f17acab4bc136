"""Boxes on feet that never slip tip over two of them where the others press no more, whatever way their plane leans.

What feet without bound bear along their plane is one choice of many; how they press is not, where there are three: it
is balanced by hand. What follows is the rotation about the line of the two that stay, an equation of its own.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

WEIGHT, HEIGHT = 9.81, 0.5
MOMENTS = np.array([0.3, 0.4, 0.5])
AT = np.array([0.05, 0.1, 0.4])


class Box:
    """Of 1 kg, its centre over the origin, under a force that grows with time, at a point of its own."""

    def __init__(self, seed, count, unit=1.0):
        rng = np.random.default_rng(seed)
        while True:
            angle, radius = np.sort(rng.uniform(0, 2 * np.pi, count)), rng.uniform(0.3, 1, count)
            if np.diff(np.r_[angle, angle[0] + 2 * np.pi]).max() < 0.95 * np.pi:
                break
        self.feet = np.c_[radius * np.cos(angle), radius * np.sin(angle), np.full(count, -HEIGHT)] * unit
        self.rate = rng.normal(size=3) * [1, 1, 0.3]
        self.unit = unit

    def scene(self, turned, friction):
        scene = rb.Scene(gravity=turned @ [0, 0, -WEIGHT])
        inertia = turned @ np.diag(MOMENTS) @ turned.T * self.unit**2
        box = scene.add(rb.RigidBody(1.0, (inertia + inertia.T) / 2), position=turned @ [0, 0, HEIGHT * self.unit])
        for foot, one in zip(self.feet, friction, strict=True):
            scene.contact(box.point(turned @ foot), rb.Plane(turned @ [0, 0, 1]), friction=one)
        f = turned @ self.rate
        scene.apply(rb.Force(lambda t, x, v: [f[0] * t, f[1] * t, f[2] * t]), box, at=turned @ AT * self.unit)
        return scene, box

    def pressure(self, force):
        """Of three feet, by the balance across the plane and about two directions along it."""
        x, y, z = self.feet.T
        arm = AT * self.unit
        moment = np.cross(arm, force)
        # along the plane the feet bear -F together, at their height
        rows = np.array([np.ones(3), y, -x])
        return np.linalg.solve(rows, [WEIGHT - force[2], -moment[0] - z[0] * force[1], -moment[1] + z[0] * force[0]])

    def tips_at(self):
        """The first zero of a pressure, which are linear in time, and the foot."""
        here, slope = self.pressure(np.zeros(3)), self.pressure(self.rate) - self.pressure(np.zeros(3))
        times = np.where(slope < 0, here / -np.minimum(slope, -1e-300), np.inf)
        return times.min(), int(times.argmin())

    def turned_about(self, first, second, start, end):
        """Where the centre is after it has turned about the line of two feet since the start."""
        place = np.array([0, 0, HEIGHT * self.unit])
        pole = self.feet[first] + place
        axis = self.feet[second] - self.feet[first]
        axis /= np.linalg.norm(axis)
        center, push = place - pole, place + AT * self.unit - pole
        about = axis @ np.diag(MOMENTS) @ axis * self.unit**2 + center @ center - (axis @ center) ** 2

        def rate(t, state):
            now = Rotation.from_rotvec(axis * state[0])
            moment = np.cross(now.apply(center), [0, 0, -WEIGHT]) + np.cross(now.apply(push), self.rate * t)
            return [state[1], axis @ moment / about]

        angle = solve_ivp(rate, [start, end], [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-15).y[0, -1]
        return pole + Rotation.from_rotvec(axis * angle).apply(center)


def attitude(seed, is_turned):
    return Rotation.random(random_state=seed).as_matrix() if is_turned else np.eye(3)


def ended(scene, until, **options):
    """The run, or what there is of it: far on, feet that never slip may have no forces."""
    try:
        return rb.simulate(scene, until, **options)
    except rb.IntegrationError as failure:
        return failure.run


@pytest.mark.parametrize("unit", [1.0, 1e-4])
@pytest.mark.parametrize("is_turned", [False, True])
@pytest.mark.parametrize("seed", [1, 6, 9, 11, 14, 22])
def test_three_feet_tip_where_one_presses_no_more(seed, is_turned, unit):
    """They went on switching at one instant, or stood for ever with a foot that pulled."""
    box, turned = Box(seed, 3, unit), attitude(seed, is_turned)
    time, foot = box.tips_at()
    scene, body = box.scene(turned, [rb.Coulomb(np.inf)] * 3)
    quick = np.sqrt(unit)
    run = ended(scene, time + 0.5 * quick, rtol=1e-11)
    first = run.events[0]
    assert (first.kind, first.name) == ("detach", f"contact {foot + 1}")
    assert first.time == pytest.approx(time, rel=1e-12)
    # until another one opens or the time is over
    end = time + 0.9 * (min([e.time for e in run.events[1:]] + [run.end]) - time)
    assert end > time + 0.1 * quick
    others = [k for k in range(3) if k != foot]
    expected = turned @ box.turned_about(*others, time, end)
    assert np.linalg.norm(run[body].position(end) - expected) < 1e-9 * unit


@pytest.mark.parametrize("is_turned", [False, True])
@pytest.mark.parametrize("seed", [0, 4, 5, 8, 12])
def test_four_feet_tip_where_those_of_finite_friction_do(seed, is_turned):
    """Before anything slips a coefficient of 1000 does the same as one without bound."""
    box, turned = Box(seed, 4), attitude(seed, is_turned)
    much, body = box.scene(np.eye(3), [rb.Coulomb(1e3)] * 4)
    held = ended(much, 8.5, rtol=1e-11)
    opened = [(e.name, e.time) for e in held.events[:2]]
    assert [e.kind for e in held.events[:2]] == ["detach", "detach"]
    scene, body_without = box.scene(turned, [rb.Coulomb(np.inf)] * 4)
    run = ended(scene, 8.5, rtol=1e-11)
    assert [e.kind for e in run.events[:2]] == ["detach", "detach"]
    assert {e.name for e in run.events[:2]} == {name for name, _ in opened}
    assert [e.time for e in run.events[:2]] == pytest.approx([t for _, t in opened], rel=1e-9)
    end = opened[1][1] + 0.5
    assert run[body_without].position(end) == pytest.approx(turned @ held[body].position(end), abs=1e-8)
