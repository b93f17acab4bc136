"""Impacts with friction and restitution against their closed forms, in forty digits."""

from decimal import Decimal as D
from decimal import getcontext

import numpy as np
import pytest
import rbdyn as rb

getcontext().prec = 40
g, m, r = D("9.8125"), D("0.5"), D("0.125")


def bounces(velocity, spin, height, restitution, mu, count):
    """Of a ball thrown on a floor: the times of its impacts, their impulses, places, velocities and spins after them.

    The slip s = v + w x (-r e_z) keeps its direction in an impact: an impulse T takes 7 T / (2 m) of it, until
    none is left."""
    v, w, e = [D(c) for c in velocity], [D(c) for c in spin], D(restitution)
    place, t, told = [D(0), D(0), D(height)], D(0), []
    fall = (v[2] + (v[2] ** 2 + 2 * g * (place[2] - r)).sqrt()) / g
    for _ in range(count):
        t += fall
        place = [place[0] + v[0] * fall, place[1] + v[1] * fall, r]
        down = v[2] - g * fall
        normal = -m * (1 + e) * down
        slip = [v[0] - w[1] * r, v[1] + w[0] * r]
        size = (slip[0] ** 2 + slip[1] ** 2).sqrt()
        part = min(D(mu) * normal, 2 * m * size / 7) / size if size else D(0)
        push = [-part * slip[0], -part * slip[1]]
        v = [v[0] + push[0] / m, v[1] + push[1] / m, -e * down]
        # r x T over 2/5 m r^2
        w = [w[0] + D("2.5") * push[1] / (m * r), w[1] - D("2.5") * push[0] / (m * r), w[2]]
        told.append((t, [*push, normal], place, v, w))
        fall = 2 * v[2] / g
    return told


THROWN = [
    (["3", "0", "0"], ["0", "-24", "0"], "1.5", "0.75", "0.0625"),
    (["1.25", "-2.5", "0.5"], ["40", "10", "-30"], "0.75", "0.875", "0.09375"),
    (["-0.5", "0.25", "-1"], ["-8", "64", "5"], "2", "0.5", "0.1875"),
]


@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("case", range(len(THROWN)))
def test_a_ball_that_spins_bounces_off_a_rough_floor_as_in_forty_digits(case, error):
    velocity, spin, height, e, mu = THROWN[case]
    told = bounces(velocity, spin, height, e, mu, 9)
    scene = rb.Scene(gravity=[0, 0, -float(g)])
    ball = scene.add(
        rb.shapes.sphere(float(m), float(r)),
        position=[0, 0, float(height)],
        velocity=[float(c) for c in velocity],
        angular_velocity=[float(c) for c in spin],
    )
    touch = scene.contact(
        ball.sphere(float(r)), rb.Plane([0, 0, 1]), restitution=float(e), friction=rb.Coulomb(float(mu))
    )
    # to the middle of the flight after the last of them
    end = float(told[-1][0] + told[-1][3][2] / g)
    run = rb.simulate(scene, until=end, error=error)
    assert run.error <= error
    strikes = run.events.times("impact", touch)
    assert len(strikes) == len(told)
    fastest, turning, far = 5.0, 64.0, 3.0
    for event, (t, push, place, v, w) in zip([f for f in run.events if f.kind == "impact"], told, strict=True):
        assert abs(D(event.time) - t) < D(error) * t
        assert max(abs(D(one) - other) for one, other in zip(event.impulse, push, strict=True)) < D(error * fastest)
        assert max(abs(D(a) - b) for a, b in zip(run[ball].position(event.time), place, strict=True)) < D(error * far)
        assert max(abs(D(a) - b) for a, b in zip(run[ball].velocity(event.time), v, strict=True)) < D(error * fastest)
        assert max(abs(D(a) - b) for a, b in zip(run[ball].angular_velocity_world(event.time), w, strict=True)) < D(
            error * turning
        )
    # some of them slide and some do not
    stuck = [np.hypot(float(p[0]), float(p[1])) < 0.999 * float(mu) * float(p[2]) for _, p, *_ in told]
    assert any(stuck) and not all(stuck)


def axes_of(w, x, y, z):
    """The axes that a quaternion turns the world's into."""
    w, x, y, z = np.array([w, x, y, z]) / np.linalg.norm([w, x, y, z])
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


@pytest.mark.parametrize("r", [0.001, 0.02, 0.4])
@pytest.mark.parametrize("mu", [1e-7, 1e-6, 1e-5, 1e-3])
def test_a_little_friction_turns_a_ball_by_itself_not_by_rounding_of_the_force_through_its_centre(mu, r):
    """A ball that slides through its impact on a turned floor is turned by friction alone, 5 mu (1 + e) v_n / (2 r):
    the force along the normal passes its centre. With an arm of rounding it turned what so little friction turns
    by 3e-10 of it, and 2.5e-12 was told."""
    speed = (2 * g * D(3)).sqrt()
    turned = float(D("2.5") * D(mu) * D("1.75") * speed / D(r))
    for axes in (np.eye(3), axes_of(0.3, -0.5, 0.2, 0.7), axes_of(0.9, 0.1, -0.6, 0.25)):
        along, across, up = axes.T
        scene = rb.Scene(gravity=-float(g) * up)
        ball = scene.add(rb.shapes.sphere(2.0, r), position=(3 + r) * up, velocity=0.75 * along)
        scene.contact(ball.sphere(r), rb.Plane(up), restitution=0.75, friction=rb.Coulomb(mu))
        run = rb.simulate(scene, until=1.0, error=1e-9)
        after = run[ball].angular_velocity_world(0.9)
        assert after @ across == pytest.approx(turned, rel=1e-12)
        assert abs(after @ up) + abs(after @ along) < 1e-12 * turned
