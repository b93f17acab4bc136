"""How runs of random scenes with contacts end: the short form of contact_endings.py, which runs thousands of them."""

import itertools
import math

import contact_endings
import pytest
import rbdyn as rb

OPTIONS = {"rtol": 1e-12, "max_steps": 1500}
# what a user would call a failure once: a direction that turns as a slip begins (2, 6, 8), slips that end under forces
# of thousands of weights (970, 1180), forces not found of a rod that lies between floor and wall (86, 2218); what
# went on switching at one instant (2829 and on), and crept (6572); and bounces without loss by some 1e-12 m (431, 998)
SEEDS = {
    ("planar", False): [*range(40), 998],
    ("planar", True): [*range(40), 86, 431, 2218, 2829, 3261, 4521, 4611, 5410, 6534, 6572, 7049, 9617],
    ("space", False): range(20),
    ("space", True): [*range(20), 95, 719, 970, 1180],
}
NAMED = (
    "reached its end",
    # more impacts than were asked for
    "step limit",
    # Painleve's configurations, and what jams
    "no forces of contacts satisfy the laws of friction",
    "no force keeps contacts sliding",
    "are not unique, and the motion depends on",
    "several velocities after the impact satisfy the laws",
)


@pytest.mark.parametrize(("kind", "rough"), SEEDS)
def test_nothing_is_wrong_and_each_end_has_a_name(kind, rough):
    early = []
    for seed in SEEDS[kind, rough]:
        end, wrong = contact_endings.outcome(kind, seed, rough, OPTIONS)
        assert not wrong, (seed, end, wrong)
        assert any(name in end for name in NAMED), (seed, end)
        if end != "reached its end":
            early.append(seed)
    assert len(early) <= 2, early


def test_bounces_beside_what_slides_come_to_an_end():
    """A rod between floor and wall, thrown back by the floor as fast as it came: the wall takes from it what ends it,
    down to speeds at which its slip there has no direction."""
    assert contact_endings.outcome("planar", 2136, True, OPTIONS) == ("reached its end", [])
    scene, _, _ = contact_endings.built("planar", 2136, True)
    run = rb.simulate(scene, contact_endings.UNTIL, **OPTIONS)
    end = next(e for e in run.events if e.kind == "accumulation" and e.name == "contact 1")
    times = [e.time for e in run.events if e.kind == "impact" and e.name == end.name and end.time - 1e-9 < e.time]
    # all but the last ones are known to digits of their ratio
    gaps = [b - a for a, b in zip(times[:6], times[1:6], strict=False)]
    ratio = gaps[-1] / gaps[-2]
    assert ratio == pytest.approx(gaps[1] / gaps[0], rel=1e-3) and ratio < 0.4
    assert end.time == pytest.approx(times[5] + gaps[-1] * ratio / (1 - ratio), abs=1e-12)


def test_its_messages_are_told_by_class():
    why = (
        "IntegrationError: simulate: inconsistent at t = 1.35e-05 s: no forces of contact 4, contact 15 do. No motion."
    )
    assert contact_endings.ending(why).endswith("inconsistent: no forces of contacts do. No motion.")


def test_rods_that_no_force_keeps_sliding_end_by_that_name():
    """Painleve's rod of the reference, and others like it: wherever the last step ends before the force is infinite."""
    half, named = 0.5, 0
    for mu, rate, speed in itertools.product((0.99, 1.0), (2.0, 2.1, 2.3), (0.9, 1.0, 1.2)):
        scene = rb.Scene(gravity=[0, -9.8125, 0])
        across, up = half * math.cos(0.5), half * math.sin(0.5)
        rod = scene.add(
            rb.shapes.rod(1.0, 2 * half, [1, 0, 0]),
            rb.Planar([1, 0, 0], [0, 1, 0]),
            position=[across, up],
            velocity=[-20 * speed - rate * up, rate * across],
            angle=0.5,
            rate=rate,
        )
        scene.contact(rod.point([-half, 0, 0]), rb.Plane([0, 1, 0]), friction=rb.Coulomb(1.75 * mu))
        with pytest.raises(rb.IntegrationError, match="Painleve") as end:
            rb.simulate(scene, 1.0, rtol=1e-11)
        named += end.value.run.status == "inconsistent" and 0.05 < end.value.run.end < 0.15
    assert named == 18
