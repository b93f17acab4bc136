"""Random planar scenes of up to six contacts, smooth and rough, and a sample of them against time stepping.

Nothing goes through anything, no energy is gained, each run ends as asked or says why.

RBDYN_TEST_SCENES: how many of each kind (120); RBDYN_TEST_STEPPED: how many of the sample of each kind (5).
"""

import os

import numpy as np
import pytest
import rbdyn as rb
from planar_scenes import random_scene, stepped

SCENES = int(os.environ.get("RBDYN_TEST_SCENES", "120"))
STEPPED = int(os.environ.get("RBDYN_TEST_STEPPED", "5"))
# impacts that follow each other within some of the finest steps [s]: these see them at once, or in another order
FOLLOW = 1e-4
# of which something was wrong once: a ball that fell along a rough wall and struck the floor struck the wall again and
# again by the rounding of its velocity, and one that came to rest in a corner had no direction to slide in
KNOWN = {False: [], True: [1176]}


def simulated(planar, until):
    """The run, its bodies and contacts, and why it ended early: bounces without loss have no end."""
    scene, bodies, contacts = planar.scene()
    try:
        run = rb.simulate(scene, until=until, rtol=1e-12, max_steps=5000)
        if run.status == "step limit":
            # nothing but corners without loss that bounce on
            lossless = {contacts[k] for k, contact in enumerate(planar.contacts) if contact.restitution == 1.0}
            assert all(event.kind == "impact" and event.subject in lossless for event in run.events[-1000:])
        else:
            assert run.status == "reached end"
        return run, bodies, contacts, ""
    except rb.IntegrationError as failure:
        return failure.run, bodies, contacts, str(failure)


@pytest.mark.parametrize("rough", [False, True])
def test_nothing_goes_through_and_no_energy_is_gained(rough):
    ended = []
    for seed in [*range(SCENES), *KNOWN[rough]]:
        planar = random_scene(seed, rough=rough)
        run, _, contacts, why = simulated(planar, 1.5)
        if why:
            # Painleve's configurations, and forces that are not unique where the motion depends on them
            assert rough and ("no forces of contacts satisfy" in why or "are not unique" in why), (seed, why)
            ended.append(seed)
        if run.end == 0.0:
            continue
        t = np.linspace(0, run.end, 61)
        energy = run.energy(t)
        assert np.diff(energy).max() < 1e-11 * abs(energy).max(), seed
        for contact, c in zip(contacts, planar.contacts, strict=True):
            # sizes here are some tenths of a metre
            assert run[contact].gap(t).min() > -1e-13, seed
            force = run[contact].force(t)
            assert np.isfinite(force).all(), seed
            if c.other < 0:
                normal = force[:, :2] @ c.normal
                across = force[:, 1] * c.normal[0] - force[:, 0] * c.normal[1]
                assert (normal >= -1e-12).all() and (abs(across) <= c.mu * normal + 1e-9).all(), seed
    assert len(ended) <= 0.01 * SCENES, ended


def until_one_law_holds(planar, run, contacts):
    """Up to the first impact of several contacts at once, of bodies that touch elsewhere, with less restitution, or to
    impacts that follow each other within some steps.

    What time stepping goes to there depends on which of them is first by a step.
    """

    def bodies(k):
        return {planar.contacts[k].body, planar.contacts[k].other} - {-1}

    last = -1.0
    for event in run.events:
        if event.kind not in ("impact", "land", "accumulation"):
            continue
        if event.time - last < FOLLOW:
            return last
        last = event.time
        struck = contacts.index(event.subject)
        for k, contact in enumerate(contacts):
            if k == struck or not bodies(k) & bodies(struck):
                continue
            closed = run[contact].state(event.time, side="before") != "open"
            if closed or abs(run[contact].gap(event.time)) < 1e-9:
                return event.time
        if event.note:
            return event.time
    return run.end


@pytest.mark.parametrize("rough", [False, True])
def test_time_stepping_goes_to_the_same_motion(rough):
    for seed in range(STEPPED):
        planar = random_scene(seed, rough=rough)
        run, handles, contacts, _ = simulated(planar, 0.8)
        # a little before, for steps see an event up to a step late
        t = 0.999 * until_one_law_holds(planar, run, contacts)
        exact = np.array(
            [[*run[b].position(t)[:2], run[b].angle(t), *run[b].velocity(t)[:2], run[b].rate(t)] for b in handles]
        )
        coarse = abs(stepped(planar, t, 500) - exact).max()
        for steps in (8000, 32000, 128000):
            fine = abs(stepped(planar, t, steps) - exact).max()
            if fine < 2e-3:
                break
        # in proportion to the step, as far as it is not small (an impact a step late just before the end is not)
        assert fine < max(2e-3, coarse / 64), (seed, t, coarse, fine)


def test_of_a_run_that_was_stopped_before_a_part_of_it_began_contacts_can_be_asked():
    """Bodies that nothing joins are solved one after the other; asking for a contact of the second one crashed."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    balls, contacts = [], []
    for k in range(2):
        balls.append(scene.add(rb.shapes.sphere(1.0, 0.1), position=[k, 0, 1], velocity=[0, 0, k]))
        contacts.append(scene.contact(balls[-1].sphere(0.1), rb.Plane([0, 0, 1]), restitution=1.0))
    spring = scene.connect(rb.Spring(stiffness=1.0), balls[1], [1, 0, 2])

    def stop(_):
        raise TimeoutError

    with pytest.raises(TimeoutError) as stopped:
        rb.simulate(scene, 1e5, rtol=1e-12, progress=stop)
    run = stopped.value.run
    assert run.end == 0.0
    for ball, contact in zip(balls, contacts, strict=True):
        assert (run[ball].position(0.0)[2], run[contact].gap(0.0), run[contact].state(0.0)) == (1.0, 0.9, "open")
        assert not run[contact].force(0.0).any()
    assert np.isfinite(run[spring].force(0.0)).all()


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_two_balls_that_land_together_have_the_same_bits_in_either_order_of_writing(mu):
    def run_of(order):
        scene = rb.Scene(gravity=[0, 0, -9.81])
        balls = {}
        for k in order:
            balls[k] = scene.add(
                rb.shapes.sphere(1.0 + k, 0.1),
                position=[k, 0, 0.6],
                velocity=[0.3, 0, 0],
                angular_velocity=[0, 1 + k, 0],
            )
        for k in order:
            friction = rb.Coulomb(mu) if mu > 0 else None
            scene.contact(balls[k].sphere(0.1), rb.Plane([0, 0, 1]), restitution=0.5, friction=friction)
        return rb.simulate(scene, 3.0, rtol=1e-12), balls

    (one, balls), (other, same) = run_of([0, 1]), run_of([1, 0])
    assert sorted((e.time, e.kind) for e in one.events) == sorted((e.time, e.kind) for e in other.events)
    t = np.linspace(0, 3, 61)
    for k in range(2):
        for name in ("position", "velocity", "angular_velocity"):
            assert (getattr(one[balls[k]], name)(t) == getattr(other[same[k]], name)(t)).all()
