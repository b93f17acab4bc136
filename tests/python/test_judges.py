"""A run that another one is held against, and that breaks off, is no agreement: it is told, with words."""

import numpy as np
import pytest
import rbdyn as rb


def billiard(broken):
    """A ball between a disc and four walls, told by watched functions, under a force that is called back: nothing, but
    no number from 6 s on in those of all runs that are broken(number)."""
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1.25, 0.3, 0], velocity=[-1.0, 0.37, 0])
    runs = [0]

    def force(t, position, velocity):
        return [float("nan") if float(t) > 6.0 and broken(runs[0]) else 0.0, 0, 0]

    def reflect(normal):
        def act(now):
            # each run has its first bounce
            runs[0] += now.time < 0.4
            n = normal(np.array(now[ball].position))
            v = np.array(now[ball].velocity)
            return {ball: {"velocity": v - 2 * (v @ n) / (n @ n) * n}}

        return act

    scene.apply(rb.Force(force), ball)

    def outside(now):
        x, y, _ = now[ball].position
        return x**2 + y**2 - 1.0

    scene.watch("disc", outside, direction="falling", action=reflect(lambda r: np.array([r[0], r[1], 0.0])))
    for k in range(2):
        scene.watch(
            f"wall {k}",
            lambda now, k=k: now[ball].position[k] ** 2 - 1.69,
            direction="rising",
            action=reflect(lambda r, k=k: np.eye(3)[k]),
        )
    return scene, runs


def test_where_events_multiply_rounding_two_are_asked():
    scene, runs = billiard(lambda number: False)
    run = rb.simulate(scene, until=8.0, error=1e-6, engine="dop853")
    assert run.statistics.runs == runs[0] == 3


@pytest.mark.parametrize("number", [2, 3])
def test_one_that_breaks_off_is_no_agreement(number):
    """Asked again, more tightly, it agrees."""
    scene, runs = billiard(lambda run: run == number)
    run = rb.simulate(scene, until=8.0, error=1e-6, engine="dop853")
    assert run.statistics.runs == runs[0] > 3
    assert run.status == "reached end"


def test_where_it_always_breaks_off_that_is_said():
    """The better run of each pair."""
    scene, _ = billiard(lambda run: run % 2 == 0)
    with pytest.raises(rb.AccuracyError) as caught:
        rb.simulate(scene, until=8.0, error=1e-6, engine="dop853")
    said = str(caught.value)
    assert (
        "cannot tell which events this motion has, for a run that it is held against is not finite at t = 6.0" in said
    )
    assert caught.value.run.certain_until < 6.1
