"""Scenes in parts: bodies that nothing joins are solved apart, and the run is one."""

import copy

import numpy as np
import pytest
import rbdyn as rb

G = 9.8125
DOWN = [0, 0, -G]


def add_bead(scene):
    hoop = rb.Rail(rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0]), friction=rb.Coulomb(0.375, 0.125))
    return scene.add(rb.Particle(0.5), hoop, name="bead", parameter=0.0, speed=3.0)


def add_pendulum(scene):
    bar = rb.shapes.rod(mass=1.0, length=1.5, along=[0, 0, 1]).shifted([0, 0, -0.75])
    body = scene.add(bar, rb.Revolute(axis=[0, 1, 0]), name="pendulum", angle=1.0)
    scene.watch("lowest", lambda now: now[body].angle)
    return body


def add_ball(scene):
    ball = scene.add(rb.Particle(2.0), name="ball", velocity=[1, 0, 20])
    scene.apply(rb.Force(lambda t, r, v: -0.05 * np.linalg.norm(v) * v), ball)
    return ball


ALL = [add_bead, add_pendulum, add_ball]


def together(order):
    scene = rb.Scene(gravity=DOWN)
    handles = {add.__name__: add(scene) for add in order}
    return scene, handles


@pytest.mark.parametrize("order", [[0, 1, 2], [2, 0, 1], [1, 2, 0], [2, 1, 0]])
def test_each_part_moves_bit_for_bit_as_it_does_alone_in_any_order(order):
    scene, handles = together([ALL[i] for i in order])
    run = rb.simulate(scene, 5.0, error=1e-10)
    t = np.linspace(0, 5, 101)
    seen, errors, steps = [], [], 0
    for add in ALL:
        one = rb.Scene(gravity=DOWN)
        body = add(one)
        alone = rb.simulate(one, 5.0, error=1e-10)
        motion = run[handles[add.__name__]]
        for name in alone[body].quantities:
            for side in ("before", "after"):
                a, b = (getattr(m, name)(t, side=side) for m in (alone[body], motion))
                np.testing.assert_array_equal(np.asarray(a), np.asarray(b), err_msg=name)
        seen += [(e.time, e.kind, e.name) for e in alone.events]
        errors.append(alone.error)
        steps += alone.statistics.steps
    assert sorted(seen) == sorted((e.time, e.kind, e.name) for e in run.events)
    assert run.error == max(errors) and run.statistics.steps == steps
    assert run.status == "reached end" and np.all(np.diff(run.t) > 0) and run.t[-1] == 5.0
    assert {e.subject for e in run.events if e.kind == "stick"} == {handles["add_bead"]}


def test_the_plan_says_which_parts_there_are_and_what_would_join_them():
    scene, handles = together(ALL)
    plan = rb.plan(scene)
    assert [p.engine for p in plan.parts] == ["taylor", "closed form", "taylor"]
    assert plan.engine == "taylor, closed form"
    assert "3 parts, solved apart: bead (taylor), pendulum (closed form), ball (taylor)" in str(plan)
    assert "gravity" in plan.effects and "dynamic friction" in plan.effects and len(plan.coordinates) == 3
    assert "rotation" not in plan.parts[0].effects
    spring = scene.connect(rb.Spring(1.0), handles["add_bead"], handles["add_ball"])
    assert [p.engine for p in rb.plan(scene).parts] == ["taylor", "closed form"]
    run = rb.simulate(scene, 1.0)
    assert run.engine == "taylor, closed form" and run[spring].length(1.0) > 0
    scene.watch("opaque", lambda now: 1.0 if now.time > 0.5 else -1.0, trace=False)
    plan = rb.plan(scene)
    assert plan.parts == [] and any(o.what == "parts" and "opaque" in o.why for o in plan.omissions)


def test_what_is_asked_of_the_whole_is_asked_of_every_part():
    scene, handles = together(ALL)
    bead, pendulum, ball = handles.values()
    idle = scene.connect(rb.Spring(0.0), bead, ball)
    scene.integral("both", lambda now: now[bead].kinetic_energy + now[ball].kinetic_energy * now[idle].length)
    run = rb.simulate(scene, 2.0)
    assert len(run.plan.parts) == 3 and "both" in run.drift
    t = np.linspace(0, 2, 11)
    parts = [run.kinetic_energy(t, of=h) for h in handles.values()]
    np.testing.assert_allclose(run.kinetic_energy(t), sum(parts), rtol=1e-14)
    np.testing.assert_allclose(
        run[idle].length(t), np.linalg.norm(run[bead].position(t) - run[ball].position(t), axis=1)
    )
    assert abs(run.work(0, 2) - (run.kinetic_energy(2.0) - run.kinetic_energy(0.0))) < 1e-7
    sample = run.sample(t)
    np.testing.assert_array_equal(sample[pendulum]["angle"], run[pendulum].angle(t))
    with pytest.raises(rb.InvalidInput):
        run[pendulum].angle(2.5)


def test_a_number_shared_by_parts_joins_nothing():
    k = rb.parameter(4.0, "k")
    scene = rb.Scene()
    bodies = [scene.add(rb.Particle(1.0), position=[x, 0, 0]) for x in (1.0, 2.0)]
    for body in bodies:
        scene.apply(rb.Force(lambda t, r, v: -k * r), body)
    run = rb.simulate(scene, 3.0, error=1e-12)
    assert len(run.plan.parts) == 2
    for body, x in zip(bodies, (1.0, 2.0), strict=True):
        assert abs(run[body].position(3.0)[0] - x * np.cos(6.0)) < 1e-11


def test_a_function_that_is_called_back_leaves_the_other_parts_their_engines():
    scene, handles = together(ALL)
    odd = scene.add(rb.Particle(1.0), name="odd")
    scene.apply(rb.Force(lambda t, r, v: [0.0, 0.0, 1.0 if t > 1 else 0.0], trace=False), odd)
    run = rb.simulate(scene, 2.0, rtol=1e-8)
    assert run.engine == "taylor, closed form, dop853" and run.error is None
    assert run.statistics.python_calls > 0
    with pytest.raises(rb.InvalidInput, match="called back"):
        rb.simulate(scene, 2.0, engine="taylor")


def test_an_event_that_stops_one_part_ends_all():
    scene, handles = together(ALL)
    ball, pendulum = handles["add_ball"], handles["add_pendulum"]
    scene.watch("top", lambda now: now[ball].velocity[2], action="stop")
    run = rb.simulate(scene, 20.0, error=1e-11)
    assert run.status == "stopped by event" and run.events[-1].name == "top" and run.end == run.events[-1].time
    assert abs(run[ball].velocity(run.end)[2]) < 1e-10
    one = rb.Scene(gravity=DOWN)
    body = add_pendulum(one)
    alone = rb.simulate(one, run.end, error=1e-11)
    np.testing.assert_array_equal(run.events.times("lowest"), alone.events.times("lowest"))
    assert run[pendulum].angle(run.end) == alone[body].angle(run.end)
    for handle in handles.values():
        with pytest.raises(rb.InvalidInput):
            run[handle].position(run.end + 1e-3)


def test_an_error_out_of_reach_in_one_part_is_one_of_the_run():
    scene, handles = together([add_bead])
    stone = scene.add(rb.RigidBody(1.0, [1, 2, 3]), name="stone", angular_velocity=[1e-9, 1.0, 1e-9])
    with pytest.raises(rb.AccuracyError, match="stone") as raised:
        rb.simulate(scene, 60.0, error=1e-13, engine="dop853")
    run = raised.value.run
    assert run.status == "accuracy not reached" and 0 < run.certain_until < 60.0
    assert run[handles["add_bead"]].speed(60.0) == 0.0 and run[stone].quaternion(60.0).shape == (4,)


def test_what_progress_raises_carries_what_was_solved():
    scene, handles = together(ALL)
    fast = scene.add(
        rb.RigidBody(1.0, [1.0, 2.0, 3.0], com=[0.1, 0.2, 0.3]), rb.Spherical(), angular_velocity=[0, 50, 0]
    )

    def give_up(fraction):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough") as raised:
        rb.simulate(scene, 1e5, rtol=1e-12, progress=give_up)
    run = raised.value.run
    assert run.status == "stopped by user" and run.certain_until == 0.0
    assert all(np.isfinite(run[h].position(run.end)).all() for h in (*handles.values(), fast))


def test_a_run_keeps_its_scene_whatever_becomes_of_it():
    scene, handles = together(ALL)
    copied = copy.deepcopy(scene)
    assert copied == scene
    run, again = rb.simulate(scene, 2.0), rb.simulate(copied, 2.0)
    motion = run[handles["add_pendulum"]]
    angle = motion.angle(1.0)
    assert again[handles["add_pendulum"]].angle(1.0) == angle
    del scene, run
    assert motion.angle(1.0) == angle and "angle" in motion.quantities
