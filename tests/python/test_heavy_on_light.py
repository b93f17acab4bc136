"""Impacts of a heavy body on a light one that strikes the ground at the same instant, against Newton's law itself: each
contact parts with e times the speed it came with, so that both bodies go back as they came, whatever their masses."""

import pytest
import rbdyn as rb


def struck(mass, e, friction=None):
    """Both gaps are 0.5 m and close at 1 m/s."""
    scene = rb.Scene()
    one, other = (rb.RigidBody(m, [1, 1, 1]) for m in (1.0, mass))
    light = scene.add(one, rb.Prismatic([0, 0, 1]), displacement=1.0, rate=-1.0)
    heavy = scene.add(other, rb.Prismatic([0, 0, 1]), displacement=3.0, rate=-2.0)
    scene.contact(light.point([0, 0, -0.5]), rb.Plane([0, 0, 1]), restitution=e, friction=friction)
    scene.contact(heavy.point([0, 0, -1]), light.plane([0, 0, 1], point=[0, 0, 0.5]), restitution=e, friction=friction)
    return scene, light, heavy


# e = 1 with friction is lowered where rounding of the impulses would gain energy, by up to 3e-10, which the event tells
@pytest.mark.parametrize(
    ("e", "friction"), [(0.0, None), (0.5, None), (1.0, None), (0.0, rb.Coulomb(0.3)), (0.5, rb.Coulomb(0.3))]
)
@pytest.mark.parametrize("mass", [1e-10, 1e-4, 1.0, 1e2, 1e4, 1e6, 1e8, 1e10])
def test_both_go_back_as_they_came(mass, e, friction):
    scene, light, heavy = struck(mass, e, friction)
    run = rb.simulate(scene, 0.75, error=1e-12)
    # 1e-12 of speeds of 2 m/s
    assert abs(run[light].rate(0.75) - e) < 2e-12
    assert abs(run[heavy].rate(0.75) - 2 * e) < 2e-12


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("mass", [1e12, 1e14, 1e16])
def test_where_doubles_have_no_digits_of_the_light_one_that_is_said(mass, e):
    """The heavy body never goes through the light one."""
    scene, _, _ = struck(mass, e)
    with pytest.raises(rb.IntegrationError, match="doubles have no digits of the impulses"):
        rb.simulate(scene, 0.75)


def test_a_light_ball_with_a_heavy_one_on_it_comes_back_as_fast_as_the_law_says():
    """Both come with one speed and leave with e times that, of whatever rounding the sums of their impulses are."""
    scene = rb.Scene(gravity=[0, -9.8125, 0])
    balls = [
        scene.add(rb.RigidBody(m, [0.1 * m] * 3), rb.Planar([1, 0, 0], [0, 1, 0]), position=[0, y])
        for m, y in ((1e-4, 1.0), (1e4, 1.5))
    ]
    scene.contact(balls[0].sphere(0.25), rb.Plane([0, 1, 0]), restitution=0.5)
    scene.contact(balls[0].sphere(0.25), balls[1].sphere(0.25), restitution=0.5)
    run = rb.simulate(scene, 0.4, rtol=1e-12)
    (impact,) = run.events
    speed = 9.8125 * impact.time
    for ball in balls:
        assert abs(run[ball].velocity(impact.time, side="after")[1] / speed - 0.5) < 1e-14
