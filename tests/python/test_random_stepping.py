"""Random scenes in space against time stepping whose step goes to zero, up to the first impact of several at once.

RBDYN_TEST_STEPPED: how many of each kind (3); RBDYN_TEST_FIRST: the first seed.
"""

import os

import pytest
import rbdyn as rb
from space_stepping import random_scene, stepped

STEPPED = int(os.environ.get("RBDYN_TEST_STEPPED", "3"))
FIRST = int(os.environ.get("RBDYN_TEST_FIRST", "0"))
# impacts that follow each other within some of the finest steps [s]: these see them at once, or in another order
FOLLOW = 1e-4


def until_one_law_holds(space, run, contacts):
    """Up to the first impact of several contacts at once, or with less restitution, where no law has a limit, or
    to those that follow each other ever sooner.
    """

    def bodies(k):
        return {space.contacts[k].body, space.contacts[k].other} - {-1}

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
            if run[contact].state(event.time, side="before") != "open" or abs(run[contact].gap(event.time)) < 1e-9:
                return event.time
        if event.note:
            return event.time
    return run.end


def difference(seed, rough, steps=(4000, 16000, 64000)):
    """The time up to which one law holds, and how far time stepping is off there, coarsely and finely."""
    space = random_scene(seed, rough=rough)
    scene, handles, contacts = space.scene()
    try:
        run = rb.simulate(scene, 0.7, rtol=1e-12)
    except rb.IntegrationError as failure:
        run = failure.run
    # a little before, for steps see an event up to a step late
    t = 0.999 * until_one_law_holds(space, run, contacts)

    def off(count):
        places, axes, v, w = stepped(space, t, count)
        worst = 0.0
        for k, handle in enumerate(handles):
            body = run[handle]
            worst = max(
                worst,
                abs(places[k] - body.position(t)).max(),
                abs(axes[k] - body.rotation_matrix(t)).max(),
                abs(v[k] - body.velocity(t)).max(),
                # radii are some tenths of a metre
                0.3 * abs(w[k] - body.angular_velocity_world(t)).max(),
            )
        return worst

    coarse = off(250)
    for count in steps:
        fine = off(count)
        if fine < max(2e-3, coarse / 64):
            break
    return t, coarse, fine


@pytest.mark.parametrize("rough", [False, True])
def test_time_stepping_goes_to_the_same_motion(rough):
    for seed in range(FIRST, FIRST + STEPPED):
        t, coarse, fine = difference(seed, rough)
        assert fine < max(2e-3, coarse / 64), (seed, t, coarse, fine)
