"""AccuracyError says of what a motion is farthest off: of which body or constraint, and which quantity."""

import re

import pytest
import rbdyn as rb


def test_the_worst_of_a_light_link_is_named():
    """A link of 2e-8 kg that carries 5e3 kg moves by what is left of forces that are 1e11 times as large."""
    scene = rb.Scene(gravity=[0, -9.81, 0])
    light = scene.add(rb.RigidBody(2e-8, [1e-9, 1e-9, 2e-9]), rb.Revolute([0, 0, 1]), angle=0.3, rate=1.0, name="link")
    heavy = rb.RigidBody(5e3, [1e2, 1e2, 2e2], com=[0.4, 0, 0])
    scene.add(heavy, rb.Revolute([0, 0, 1], at=[1, 0, 0]), parent=light, angle=1.2, rate=-2.0, name="load")
    with pytest.raises(rb.AccuracyError) as refused:
        rb.simulate(scene, until=2.0, error=1e-13)
    said = re.search(
        r"reached [\d.e-]+ in this motion.*, at worst in the rounding of the ([a-z ]+) of (link|load)[;,]",
        str(refused.value),
    )
    assert said, str(refused.value)


def test_a_quantity_of_another_engine_is_named():
    """Two particles that pass near each other, followed by CVODE to more than it can."""
    scene = rb.Scene()
    sun = scene.add(rb.Particle(1.0), name="sun")
    comet = scene.add(rb.Particle(1e-3), position=[1, 0, 0], velocity=[0, 0.05, 0], name="comet")
    scene.connect(rb.Gravitation(1.0), sun, comet)
    with pytest.raises(rb.AccuracyError, match=r"at worst in the (position|velocity) of (sun|comet)"):
        rb.simulate(scene, until=5.0, error=1e-14, engine="dop853")
