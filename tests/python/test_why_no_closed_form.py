"""What a plan says of a scene that is linear and yet has no closed form: what joins its bodies, and what to do."""

import numpy as np
import pytest
import rbdyn as rb

BODY = rb.RigidBody(1.0, [1, 1, 1])


def slide(load):
    """A body on a spring along a slide, pushed by 3 cos 3t or by 3."""
    scene = rb.Scene()
    body = scene.add(BODY, rb.Prismatic([1, 0, 0]), displacement=0.5, name="sled")
    scene.connect(rb.Spring(7.0), body, [0, 0, 0])
    scene.apply(load, body)
    return scene, body


@pytest.mark.parametrize("rate", [0.0, 3.0])
def test_loads_along_a_slide_are_said_to_be_why_and_what_does_the_same(rate):
    """x'' + 7 x = 3 cos(rate t): a Force along the axis has the closed form, and moves alike."""
    scene, body = slide(rb.JointForce(lambda t, q, v: 3 * np.cos(rate * t)) if rate else rb.JointForce(3.0))
    assert rb.plan(scene).engine == "taylor"
    assert "a Force on sled along its axis does the same" in " ".join(str(rb.plan(scene)).split())
    run = rb.simulate(scene, until=2.0, error=1e-12)
    other, sled = slide(rb.Force(lambda t, r, v: [3 * np.cos(rate * t), 0, 0]))
    assert rb.plan(other).engine == "closed form"
    assert abs(run[body].displacement(2.0) - rb.simulate(other, until=2.0)[sled].displacement(2.0)) < 1e-11


def test_whatever_joins_bodies_is_said():
    """Each by its own words, where it was said that bodies are joined to bodies."""
    held = rb.Scene()
    bob = held.add(rb.Particle(1.0), position=[0, 0, -1])
    held.constrain(rb.Rod(1.0), bob, [0, 0, 0])
    rough, driven, chain, planar = (rb.Scene() for _ in range(4))
    rough.add(BODY, rb.Prismatic([1, 0, 0], friction=rb.Coulomb(0.1)))
    driven.add(BODY, rb.Prismatic([1, 0, 0], motion=lambda t: t))
    first = chain.add(BODY, rb.Prismatic([1, 0, 0]))
    chain.add(BODY, rb.Prismatic([1, 0, 0]), parent=first)
    planar.add(BODY, rb.Planar([1, 0, 0], [0, 1, 0]))
    for scene, why in (
        (held, "constraints have none"),
        (rough, "friction in joints has none"),
        (driven, "joints that are driven have none"),
        (chain, "bodies joined to bodies have none"),
        (planar, "joints other than hinges, slides, balls and rails have none"),
    ):
        assert f"closed form: {why} here" in " ".join(str(rb.plan(scene)).split()), why


def test_a_particle_on_a_ball_joint_is_told_of_a_rod():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    cart = scene.add(BODY, rb.Prismatic([1, 0, 0]))
    with pytest.raises(rb.InvalidInput, match="a Particle and a Rod"):
        scene.add(rb.Particle(1.0), rb.Spherical())
    # that is a bob on a body that moves: the small oscillations of a cart of 1 kg and a bob of 1 kg
    bob = scene.add(rb.Particle(1.0), position=[1e-6, 0, -1.0])
    scene.constrain(rb.Rod(float(np.hypot(1e-6, 1.0))), bob, cart.point([0, 0, 0]))
    run = rb.simulate(scene, until=1.0, error=1e-7)
    apart = run[bob].position(1.0)[0] - run[cart].displacement(1.0)
    assert abs(apart - 1e-6 * np.cos(np.sqrt(2 * 9.8125))) < 1e-12


def test_a_torque_on_a_universal_joint_is_about_its_first_axis():
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [2, 3, 4]), rb.Universal([1, 0, 0], [0, 1, 0]), angles=[0, 0], rates=[0, 0])
    scene.apply(rb.JointTorque(lambda t, q, rate: 5.0 - 0 * q), body)
    run = rb.simulate(scene, until=0.1, error=1e-12)
    # 2 theta'' = 5, about an axis of the body that stays
    assert np.allclose(run[body].angles(0.1), [0.5 * 2.5 * 0.01, 0], rtol=0, atol=1e-14)
