"""What a run says of its motion: shapes, laws of mechanics, sides of a jump, events, print."""

import numpy as np
import pytest
import rbdyn as rb

G = 9.81
ERROR = 1e-11


@pytest.fixture(scope="module")
def rough():
    """A bead that swings on a rough hoop until it sticks."""
    scene = rb.Scene(gravity=[0, 0, -G])
    hoop = rb.Rail(rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0]), friction=rb.Coulomb(0.375, 0.125))
    bead = scene.add(rb.Particle(0.5), hoop, parameter=0.0, speed=3.0)
    return rb.simulate(scene, 20.0, error=ERROR), bead


@pytest.fixture(scope="module")
def pair():
    """Two particles thrown up, a spring between them."""
    scene = rb.Scene(gravity=[0, 0, -G])
    a = scene.add(rb.Particle(1.0), name="a", position=[0, 0, 0], velocity=[1, 0, 3])
    b = scene.add(rb.Particle(3.0), name="b", position=[1, 0, 0], velocity=[0, 1, 3])
    spring = scene.connect(rb.Spring(stiffness=20.0, rest_length=0.8), a, b)
    return rb.simulate(scene, 2.0, error=ERROR), a, b, spring


def test_a_number_gives_a_vector_and_an_array_gives_rows(rough, pair):
    run, bead = rough
    for name in run[bead].quantities:
        quantity = getattr(run[bead], name)
        one, several, none = quantity(1.0), quantity(np.linspace(0, 1, 7)), quantity([])
        if isinstance(one, float):
            assert several.shape == (7,) and none.shape == (0,)
        else:
            assert one.shape == (3,) and several.shape == (7, 3) and none.shape == (0, 3)
        np.testing.assert_array_equal(quantity([1.0])[0], one)
        np.testing.assert_array_equal(quantity(np.float64(1.0)), quantity(1))
    run, a, b, spring = pair
    assert isinstance(run[spring].length(0.5), float) and run[spring].force([0.5, 0.6]).shape == (2, 3)
    assert isinstance(run.kinetic_energy(0.5), float) and run.energy([0.5, 0.6]).shape == (2,)
    assert run.momentum(0.5).shape == (3,) and run.angular_momentum([0.5, 0.6], pole=[1, 0, 0]).shape == (2, 3)


def test_the_laws_of_newton_hold_at_every_time(rough, pair):
    t = np.linspace(0.0, 2.0, 50)
    run, bead = rough
    motion = run[bead]
    np.testing.assert_allclose(
        0.5 * motion.acceleration(t), motion.force(t) + motion.reaction(t), rtol=0, atol=1e-12 * 50
    )
    run, a, b, spring = pair
    np.testing.assert_allclose(run[a].force(t), run[spring].force(t) + [0, 0, -G], rtol=0, atol=1e-12 * 20)


def test_the_reaction_is_the_same_vector_in_both_frames(rough):
    run, bead = rough
    t = np.linspace(0.0, 20.0, 50)
    frame = run[bead].reaction_frenet(t)
    np.testing.assert_allclose(np.linalg.norm(frame, axis=1), np.linalg.norm(run[bead].reaction(t), axis=1), rtol=1e-13)


def test_the_centre_of_mass_falls_freely_and_the_energy_stays(pair):
    run, a, b, spring = pair
    t = np.linspace(0.0, 2.0, 20)
    np.testing.assert_allclose(run.center_of_mass_acceleration(t), np.tile([0, 0, -G], (20, 1)), atol=1e-12)
    np.testing.assert_allclose(run.center_of_mass(t)[:, 2], 3 * t - G * t**2 / 2, atol=1e3 * ERROR)
    np.testing.assert_allclose(run.center_of_mass_velocity(2.0), [0.25, 0.75, 3 - 2 * G], atol=1e3 * ERROR)
    assert run.drift["energy"] < 100 * ERROR
    np.testing.assert_allclose(run.potential(t), -run.potential_energy(t))
    assert set(run.drift) == set(run.plan.integrals)


def test_quantities_of_parts_add_up_to_those_of_the_whole(pair):
    run, a, b, spring = pair
    for quantity in (run.kinetic_energy, run.power, run.momentum, run.angular_momentum):
        np.testing.assert_allclose(quantity(0.7, of=a) + quantity(0.7, of=[b]), quantity(0.7), rtol=1e-13)
        np.testing.assert_allclose(quantity(0.7, of=[a, b]), quantity(0.7), rtol=1e-15)
    np.testing.assert_allclose(run.center_of_mass(0.7, of=b), run[b].position(0.7), rtol=1e-15)
    with pytest.raises(rb.InvalidInput, match="0 handles"):
        run.momentum(0.7, of=[])


def test_the_work_of_all_forces_is_the_change_of_kinetic_energy(rough, pair):
    for run in (rough[0], pair[0]):
        change = run.kinetic_energy(1.5) - run.kinetic_energy(0.25)
        assert run.work(0.25, 1.5) == pytest.approx(change, abs=1e3 * ERROR)
        assert run.work(1.5, 0.25) == -run.work(0.25, 1.5)
    run, a, b, _ = pair
    assert run.work(0, 1, of=a) + run.work(0, 1, of=b) == pytest.approx(run.work(0, 1), abs=1e3 * ERROR)


def test_the_work_of_gravity_a_drag_and_a_spring_makes_up_the_kinetic_energy():
    scene = rb.Scene(gravity=[0, 0, -G])
    ball = scene.add(rb.Particle(0.5), position=[1, 0, 0], velocity=[0, 2, 1])
    drag = scene.apply(rb.Drag(linear=0.1), ball)
    spring = scene.connect(rb.Spring(stiffness=3.0, rest_length=0.5), ball, [0, 0, 0])
    run = rb.simulate(scene, 2.0, error=ERROR)
    v, force = run[ball].velocity(1.0), run[spring].force(1.0)
    assert run.power(1.0, of=drag) == pytest.approx(-0.1 * v @ v, rel=1e-13)
    assert run.power(1.0, of=spring) == pytest.approx(force @ v, rel=1e-13)
    fall = 0.5 * G * (run[ball].position(0.0) - run[ball].position(2.0))[2]
    gained = run.kinetic_energy(2.0) - run.kinetic_energy(0.0)
    assert run.work(0, 2, of=[drag, spring]) + fall == pytest.approx(gained, abs=1e3 * ERROR)
    assert run.work(0, 2, of=ball) == pytest.approx(gained, abs=1e3 * ERROR)


def test_the_pole_moves_the_angular_momentum_by_its_moment(pair):
    run, *_ = pair
    pole = np.array([1.0, -2.0, 0.5])
    expected = run.angular_momentum(0.3) - np.cross(pole, run.momentum(0.3))
    np.testing.assert_allclose(run.angular_momentum(0.3, pole=pole), expected, rtol=1e-12)


def test_friction_jumps_where_the_bead_turns_and_both_sides_can_be_asked(rough):
    run, bead = rough
    turn = run.events.times("reverse", bead)[0]
    before, after = (run[bead].reaction_frenet(turn, side=side)[0] for side in ("before", "after"))
    assert before == pytest.approx(-after, rel=1e-6) and before != 0.0
    assert run[bead].reaction_frenet(turn)[0] == after
    with pytest.raises(rb.InvalidInput, match='side is "left"'):
        run[bead].speed(turn, side="left")


def test_events_are_a_sequence_in_order_of_time(rough):
    run, bead = rough
    events = run.events
    assert len(events) == run.statistics.events > 2
    assert [event.time for event in events] == sorted(event.time for event in events)
    assert events[-1].kind == "stick" and events[len(events) - 1].time == events[-1].time
    assert [event.time for event in events[1:3]] == [events[1].time, events[2].time]
    assert all(event.subject == bead for event in events)
    assert {event.direction for event in events} <= {"rising", "falling", "either"}
    assert events[0].impulse == 0.0
    with pytest.raises(IndexError):
        events[len(events)]


def test_events_can_be_asked_for_by_kind_and_by_body(rough):
    run, bead = rough
    turns = run.events.times("reverse")
    assert isinstance(turns, np.ndarray) and turns.dtype == float
    np.testing.assert_array_equal(turns, [e.time for e in run.events if e.kind == "reverse"])
    np.testing.assert_array_equal(turns, run.events.times("reverse", subject=bead))
    assert run.events.times("impact").shape == (0,)
    with pytest.raises(rb.InvalidInput, match='"revers" is no name in this run and no kind of event'):
        run.events.times("revers")


def test_a_time_outside_the_run_is_refused(rough):
    run, bead = rough
    for t in (-1e-9, 20.1, np.nan, [0.0, 21.0]):
        with pytest.raises(rb.InvalidInput, match="this run goes from 0 to 20 s"):
            run[bead].speed(t)
    with pytest.raises(rb.InvalidInput, match="time is 'now'"):
        run[bead].speed("now")


def test_a_free_particle_has_no_reaction(pair):
    run, a, *_ = pair
    with pytest.raises(rb.InvalidInput, match="a: it is free"):
        run[a].reaction(0.0)
    assert "reaction" not in run[a].quantities


def test_a_run_says_how_it_went(rough):
    run, bead = rough
    assert run.status == "reached end" and run.start == 0.0 and run.end == run.certain_until == 20.0
    assert run.advice == "The motion is complete."
    assert run.engine == "taylor" and 0.0 < run.error <= ERROR
    assert run.t[0] == 0.0 and run.t[-1] == 20.0 and np.all(np.diff(run.t) > 0)
    assert str(run).startswith("Run: reached end at t = 20 s.") and not str(run).endswith("\n")
    assert repr(run).startswith("<Trajectory: reached end at t = 20 s")
    assert str(run.events[0]).startswith("t = ") and "reverse" in str(run.events)
    assert "right-hand sides" in str(run.statistics) and run.statistics.steps > 0


def test_a_hundred_thousand_times_take_no_python_each(rough):
    run, bead = rough
    t = np.linspace(0.0, 20.0, 100_000)
    assert run[bead].position(t).shape == (100_000, 3)
    assert run.energy(t).shape == (100_000,)


def test_a_sample_holds_all_quantities_of_all_things(pair):
    run, a, b, spring = pair
    sample = run.sample([0.0, 0.5, 1.0])
    np.testing.assert_array_equal(sample.t, [0.0, 0.5, 1.0])
    np.testing.assert_array_equal(sample[a]["position"], run[a].position([0.0, 0.5, 1.0]))
    np.testing.assert_array_equal(sample[spring]["length"], run[spring].length([0.0, 0.5, 1.0]))
    with pytest.raises(rb.InvalidInput, match="no body or coupling"):
        sample[rb.Scene().add(rb.Particle(1.0))]


def test_a_sample_becomes_a_table_or_a_dataset(rough):
    run, bead = rough
    sample = run.sample(np.linspace(0, 1, 5))
    pandas = pytest.importorskip("pandas")
    table = sample.to_pandas()
    assert isinstance(table, pandas.DataFrame)
    np.testing.assert_array_equal(table["bead 1", "position", "z"], sample[bead]["position"][:, 2])
    pytest.importorskip("xarray")
    dataset = sample.to_xarray()
    np.testing.assert_array_equal(dataset["bead 1.speed"], sample[bead]["speed"])


def test_a_figure_shows_what_jumps_with_both_values_at_the_time_of_the_event(rough):
    run, bead = rough
    stick = run.events.times("stick")[0]
    axes = run.plot(handle=bead).axes
    reaction = next(a for a in axes if a.get_ylabel().startswith("reaction"))
    tangent = next(line for line in reaction.get_lines() if line.get_label() == "tangent")
    times, values = tangent.get_data()
    before, after = (run[bead].reaction_frenet(stick, side=side)[0] for side in ("before", "after"))
    assert abs(after - before) > 0.1
    np.testing.assert_array_equal(values[times == stick], [before, after])
    # no slope anywhere: between other neighbours nothing jumps
    apart = np.diff(times) > 0
    assert np.abs(np.diff(values)[apart]).max() < 0.1 * abs(after - before)


def test_figures_show_free_and_guided_bodies(rough, pair, tmp_path):
    run, bead = rough
    run.plot(tmp_path / "rough.png")
    run, a, b, spring = pair
    figure = run.plot(str(tmp_path / "pair.png"), b)
    assert len(figure.axes) == 3
    for name in ("rough.png", "pair.png"):
        assert (tmp_path / name).stat().st_size > 10_000
    with pytest.raises(rb.InvalidInput, match="not a body"):
        run.plot(None, spring)


def labels_of(figure):
    return [axes.get_ylabel() for axes in figure.axes]


def test_a_figure_has_all_bodies_those_asked_for_and_quantities_by_name(pair):
    run, a, b, spring = pair
    each = ["position [m]", "velocity [m/s]"]
    assert labels_of(run.plot()) == [*each, *each, "energy [J]"]
    assert [axes.get_title(loc="left").split(" (")[0] for axes in run.plot().axes[::2]] == [a.name, b.name, ""]
    assert labels_of(run.plot(handle=[b.name])) == labels_of(run.plot(None, b)) == [*each, "energy [J]"]
    assert labels_of(run.plot(None, (a, b), ["acceleration", "energy"])) == [
        *["acceleration [m/s^2]"] * 2,
        "energy [J]",
    ]
    (axes,) = run.plot(None, b, "velocity").axes
    times, values = axes.get_lines()[-2].get_data()
    assert axes.get_lines()[-2].get_label() == "y"
    np.testing.assert_array_equal(values[:-1], run[b].velocity(times[:-1])[:, 1])
    (axes,) = run.plot(None, quantities="energy").axes
    assert axes.get_legend() is None and axes.get_xlabel() == "time [s]"
    with pytest.raises(rb.InvalidInput, match="there is no quantity 'speed'; there are position, velocity, .*, energy"):
        run.plot(None, a, ["speed"])
    with pytest.raises(rb.InvalidInput, match=f'"{spring.name}" is not a body'):
        run.plot(None, [a, spring.name])
    with pytest.raises(rb.InvalidInput, match="there is nothing to draw"):
        run.plot(None, a, [])


def test_in_a_figure_legends_cover_nothing_and_what_is_fast_hides_nothing(tmp_path):
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 1, 1], velocity=[0, 0, 3])
    scene.apply(rb.Force(lambda t, r, v: [-100 * r[0], -r[1], -1e4 * r[2]]), ball)
    figure = rb.simulate(scene, 5.0).plot(tmp_path / "fast.png", quantities="position")
    (axes,) = figure.axes
    assert axes.get_legend().get_window_extent().y0 >= axes.get_window_extent().y1
    assert sorted(axes.get_lines(), key=lambda line: line.get_zorder()) == [axes.get_lines()[i] for i in (2, 0, 1)]
