"""cost(): rows against exact motions, reasons for what is missing, predictions, tables and figures."""

import math
import pickle

import numpy as np
import pytest
import rbdyn as rb
from rbdyn.tables import price_html

pytestmark = pytest.mark.alone

ENGINES = ["taylor", "dop853", "cvode-adams", "cvode-bdf"]
DOWN = [0, 0, -9.81]


def oscillator():
    """A mass on a spring, of angular frequency 2: in closed form."""
    scene = rb.Scene()
    mass = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.connect(rb.Spring(4.0), mass, [0, 0, 0])
    return scene, mass


ECCENTRICITY = 0.3


def orbit():
    """A planet of period 2 pi, at its perihelion: no closed form of the library's."""
    scene = rb.Scene()
    e = ECCENTRICITY
    speed = math.sqrt((1 + e) / (1 - e))
    planet = scene.add(rb.Particle(1.0), position=[1 - e, 0, 0], velocity=[0, speed, 0])
    scene.apply(rb.Potential(lambda p: 1 / np.sqrt(p @ p)), planet)
    return scene, planet


def on_orbit(t):
    """Its places and velocities by Kepler's equation."""
    e, t = ECCENTRICITY, np.asarray(t)
    anomaly = t + e * np.sin(t)
    for _ in range(50):
        anomaly = anomaly - (anomaly - e * np.sin(anomaly) - t) / (1 - e * np.cos(anomaly))
    rate, b = 1 / (1 - e * np.cos(anomaly)), math.sqrt(1 - e**2)
    place = np.stack([np.cos(anomaly) - e, b * np.sin(anomaly), 0 * t], axis=-1)
    return place, np.stack([-np.sin(anomaly) * rate, b * np.cos(anomaly) * rate, 0 * t], axis=-1)


def near_graze():
    """A mass on a spring with a length, and a watch that its turning point reaches by 1e-7 only."""
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1.5, 0, 0])
    scene.connect(rb.Spring(4.0, rest_length=1.0), ball, [0, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [-((r[0] - 1) ** 3), 0, 0]), ball)
    # the motion is even about x = 1, and turns at 0.5
    scene.watch("near", lambda now: now[ball].position[0] - 0.5 - 1e-7)
    return scene, ball


def stiff():
    scene = rb.Scene(gravity=DOWN)
    a = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 0.5, 0])
    b = scene.add(rb.Particle(1.0), position=[2, 0, 0], velocity=[0, -0.5, 0])
    scene.connect(rb.Spring(10.0, rest_length=0.5), a, [0, 0, 0])
    scene.connect(rb.Spring(1e6, rest_length=1.0, damping=1e8), a, b)
    return scene


@pytest.fixture(scope="module")
def price():
    return rb.cost(orbit()[0], until=20.0)


def reasons(price):
    return {one.engine: one.reason for one in price.missing}


# --- rows ---


@pytest.mark.cvode
def test_every_engine_goes_from_loose_to_tight(price):
    assert {row.engine for row in price} == set(ENGINES)
    for engine in ENGINES:
        tolerances = [row.tolerance for row in price if row.engine == engine]
        assert tolerances[0] == 1e-3 and tolerances == sorted(tolerances, reverse=True)
    assert all(row.seconds > 0 and row.steps > 0 and row.right_hand_sides > 0 for row in price)
    assert all(row.error == max(row.motion_error, row.event_error) for row in price)
    assert price.automatic == "taylor" and reasons(price)["closed form"].startswith("cannot: ")


@pytest.mark.cvode
def test_a_row_is_the_run_that_simulate_makes_with_its_tolerance(price):
    scene, planet = orbit()
    times = np.linspace(0, 20, 2001)
    place, velocity = on_orbit(times)
    extent, fastest = np.linalg.norm(np.ptp(place, axis=0)), np.linalg.norm(velocity, axis=1).max()
    compared = 0
    for row in price:
        run = rb.simulate(scene, 20.0, rtol=row.tolerance, engine=row.engine)
        assert run.statistics.steps == row.steps
        # the rounding of Kepler's equation, solved in doubles
        if row.error < 1e-13:
            continue
        motion = run[planet]
        true = max(
            np.linalg.norm(motion.position(times) - place, axis=1).max() / extent,
            np.linalg.norm(motion.velocity(times) - velocity, axis=1).max() / fastest,
        )
        # forces are more sensitive than places; both are errors of one orbit
        assert 0.5 * true <= row.error <= 4.0 * true, row
        compared += 1
    assert compared > 15


def test_errors_are_measured_against_the_closed_form_where_there_is_one():
    scene, mass = oscillator()
    price = rb.cost(scene, until=30.0, errors=[1e-4, 1e-8], engines=["closed form", *ENGINES])
    assert price.reference == "the closed form" and price.automatic == "closed form"
    times = np.linspace(0, 30, 2001)
    for row in price:
        if row.engine == "closed form":
            assert row.error < 1e-14 and row.tolerance == 0
            continue
        run = rb.simulate(scene, 30.0, rtol=row.tolerance, engine=row.engine)
        true = np.abs(run[mass].position(times)[:, 0] - np.cos(2 * times)).max() / 2
        assert true <= row.error * 1.1 and row.error <= 4 * true, row


def test_a_closed_form_has_its_price_far_beyond_what_can_be_integrated():
    row = rb.cost(oscillator()[0], until=1e9, engines=["closed form"])[0]
    assert row.engine == "closed form" and row.steps == 0 and row.error < 1e-6


def test_an_event_that_is_missed_is_counted_and_no_part_of_the_error():
    scene, ball = near_graze()
    price = rb.cost(scene, until=4.0, engines=["taylor", "dop853"])
    (expected,) = {row.events_expected for row in price}
    # two passages a period
    run = rb.simulate(scene, 4.0, error=1e-12)
    assert expected == len(run.events) and expected >= 2
    missed = [row for row in price if not row.has_all_events]
    assert missed and all(row.events != expected for row in missed)
    for row in missed:
        loose = rb.simulate(scene, 4.0, rtol=row.tolerance, engine=row.engine)
        times = np.linspace(0, 4, 1001)
        true = np.linalg.norm(loose[ball].position(times) - run[ball].position(times), axis=1).max()
        assert 0.3 * true <= row.motion_error <= 30 * true and row.motion_error < 1e-2
    good = price.cheapest(1e-3)
    assert good.has_all_events and good not in missed
    assert "!" in str(price)


# --- what is missing ---


@pytest.mark.cvode
def test_what_cannot_do_a_scene_says_why():
    scene = rb.Scene(gravity=DOWN)
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1])
    scene.contact(ball, rb.Plane(normal=[0, 0, 1]), restitution=0.5)
    price = rb.cost(scene, until=2.0)
    assert {row.engine for row in price} == {"taylor"}
    found = reasons(price)
    assert set(found) == {"closed form", "dop853", "cvode-adams", "cvode-bdf"}
    assert all(reason.startswith("cannot: ") for reason in found.values())
    assert "this scene has contacts" in found["dop853"]


@pytest.mark.cvode
def test_what_is_called_back_has_no_taylor_series_and_a_price_all_the_same():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    # float() cannot be recorded
    scene.apply(rb.Force(lambda t, r, v: [-4 * float(r[0]), 0, 0]), ball)
    price = rb.cost(scene, until=2.0, errors=[1e-4, 1e-8])
    assert "called back" in reasons(price)["taylor"] and price.automatic == "dop853"
    times = np.linspace(0, 2, 501)
    for row in price:
        run = rb.simulate(scene, 2.0, rtol=row.tolerance, engine=row.engine)
        true = np.abs(run[ball].position(times)[:, 0] - np.cos(2 * times)).max() / 1.7
        assert 0.3 * true <= row.error <= 5 * true, row
    assert price.reference.startswith("dop853 at tolerance 2e-15 (rows of dop853: cvode-adams")


@pytest.mark.cvode
def test_stiffness_has_its_name():
    price = rb.cost(stiff(), until=1.0)
    # the automatic choice changes to it
    assert {row.engine for row in price} - {"auto"} == {"cvode-bdf"}
    missing = {one.engine: one for one in price.missing}
    for engine in ("taylor", "dop853"):
        assert missing[engine].reason.startswith("stiff: ") and missing[engine].seconds > 0.1
    # against its own tightest run, which is no row
    assert "cvode-bdf at tolerance 2e-15" in price.reference
    assert all(row.error > 0 and row.tolerance > 1e-14 for row in price)


@pytest.mark.cvode
def test_a_floor_is_said(price):
    for engine, reason in reasons(price).items():
        if engine != "closed form":
            assert reason.startswith("floor reached, an error of ")
    least = min(row.error for row in price if row.engine == "cvode-bdf")
    assert f"an error of {least:.2g}" in reasons(price)["cvode-bdf"] and least > 1e-12


@pytest.mark.cvode
def test_a_budget_that_is_too_small_says_so():
    top = rb.RigidBody(0.5, com=[0.01, 0.005, 0.05], inertia=[0.0022, 0.0019, 0.001], inertia_about="origin")
    scene = rb.Scene(gravity=DOWN)
    scene.add(top, rb.Spherical(), attitude=rb.EulerAngles(0.3, 0, 0), angular_velocity=[0, 0, 300.0])
    price = rb.cost(scene, until=500.0, budget=0.01)
    assert len(price) == 0
    found = reasons(price)
    assert set(found) == {"closed form", *ENGINES}
    assert all(found[engine].startswith("no time left") for engine in ENGINES)
    assert all(engine in str(price) for engine in ENGINES)
    with pytest.raises(rb.InvalidInput, match="0 rows; give cost\\(\\) a larger budget"):
        price.cheapest(1e-3)


def test_a_motion_that_breaks_off_raises_what_simulate_raises():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [r[0] ** 2, 0, 0]), ball)
    with pytest.raises(rb.IntegrationError, match="not finite") as caught:
        rb.cost(scene, until=10.0)
    assert 2.0 < caught.value.run.end < 4.0


def test_odd_requests_are_refused():
    scene = oscillator()[0]
    for options, message in (
        ({"engines": ["euler"]}, 'engine is "euler"; this build has auto, closed form, taylor'),
        ({"engines": []}, "engines is empty"),
        ({"budget": 0}, "budget is 0"),
        ({"budget": math.nan}, "budget is nan"),
        ({"errors": []}, "errors has 0 entries"),
        ({"errors": [1e-3, 2.0]}, "an error is 2"),
        ({"until": -1.0}, "until is -1"),
    ):
        with pytest.raises(rb.InvalidInput, match=message):
            rb.cost(scene, **{"until": 1.0, **options})


def test_one_engine_may_be_asked_for_and_auto_is_one():
    scene = orbit()[0]
    assert {row.engine for row in rb.cost(scene, 1.0, engines=["dop853"], errors=[1e-6])} == {"dop853"}
    assert {row.engine for row in rb.cost(scene, 1.0, engines=["auto"], errors=[1e-6])} == {"taylor"}
    assert reasons(rb.cost(scene, 1.0, engines=["closed form"]))["closed form"].startswith("cannot")


def test_parts_are_priced_with_what_each_is_given_by_itself():
    scene, _ = oscillator()
    planet = scene.add(rb.Particle(1.0), position=[0.7, 0, 0], velocity=[0, 1.3, 0])
    scene.apply(rb.Potential(lambda p: 1 / np.sqrt(p @ p)), planet)
    price = rb.cost(scene, 5.0, errors=[1e-6])
    assert price.automatic == rb.plan(scene).engine == "closed form, taylor"
    assert price.automatic in {row.engine for row in price}
    alone = rb.Scene()
    planet = alone.add(rb.Particle(1.0), position=[0.7, 0, 0], velocity=[0, 1.3, 0])
    alone.connect(rb.Central(lambda r: -1 / r**2), planet, [0, 0, 0])
    by_itself = rb.cost(alone, 5.0, errors=[1e-6], engines=["taylor"])
    assert next(row for row in price if row.engine == price.automatic).steps == by_itself[0].steps


# --- what is read from it ---


def test_the_cheapest_row_is_the_quickest_that_is_good_enough(price):
    best = price.cheapest(error=1e-8)
    assert best.error <= 1e-8
    assert best.seconds == min(row.seconds for row in price if row.error <= 1e-8)
    with pytest.raises(rb.InvalidInput, match="most accurate row"):
        price.cheapest(error=1e-30)


def test_the_front_is_what_nothing_beats(price):
    front = price.front()
    errors, seconds = [row.error for row in front], [row.seconds for row in front]
    assert errors == sorted(errors, reverse=True) and seconds == sorted(seconds)
    keys = {(row.engine, row.tolerance) for row in front}
    for row in price:
        beaten = any(other.error < row.error and other.seconds < row.seconds for other in price)
        assert beaten == ((row.engine, row.tolerance) not in keys)


def test_a_prediction_leads_to_the_error_it_is_for():
    random = np.random.default_rng(3)
    ratios = []
    for _ in range(8):
        scene = rb.Scene(gravity=DOWN)
        ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=random.uniform(-1, 1, 3))
        scene.connect(rb.Spring(random.uniform(5, 50), rest_length=0.5), ball, [0, 0, 0])
        price = rb.cost(scene, until=10.0, engines=["taylor", "dop853"], budget=2.0)
        exact = rb.simulate(scene, 10.0, error=1e-12)[ball]
        times = np.linspace(0, 10, 1001)
        extent = np.linalg.norm(np.ptp(exact.position(times), axis=0))
        for error in 10.0 ** random.uniform(-10, -4, 3):
            said = price.predict(error)
            assert "interpolated between the rows at tolerance" in said.basis or "measured" in said.basis
            run = rb.simulate(scene, 10.0, rtol=said.tolerance, engine=said.engine)[ball]
            ratios.append(np.linalg.norm(run.position(times) - exact.position(times), axis=1).max() / extent / error)
    # a local tolerance leads to its error by a law that has corners: orders of series change
    assert np.median(ratios) < 1.0 and max(ratios) < 10.0 and min(ratios) > 0.01


def test_a_prediction_lies_between_rows_and_nothing_is_extrapolated(price):
    least = min(row.error for row in price)
    with pytest.raises(rb.InvalidInput, match="most accurate row of this list reaches"):
        price.predict(0.1 * least)
    with pytest.raises(rb.InvalidInput, match="error is 0"):
        price.predict(0.0)
    for error in (1e-4, 1e-7, 1e-10):
        said = price.predict(error)
        rows = [row for row in price if row.engine == said.engine]
        assert min(row.seconds for row in rows) <= said.seconds <= max(row.seconds for row in rows)
        assert str(said).startswith(said.engine)
    # looser than its loosest row costs what that does
    loosest = price.predict(1e3)
    assert loosest.basis.startswith("measured at") and loosest.seconds in {row.seconds for row in price}


# --- tables and figures ---


def test_a_list_prints_itself(price):
    lines = str(price).splitlines()
    assert lines[0].split()[:2] == ["engine", "tolerance"]
    assert len(lines) == 1 + len(price) + 1 + len(price.missing) + 1
    assert sum(line.endswith("  *") for line in lines) == len(price.front())
    assert lines[-1] == f"errors against {price.reference}" and "auto takes taylor" in str(price)
    assert len(price) == len(price.rows) and price[-1].engine == price.rows[-1].engine
    with pytest.raises(IndexError):
        price[len(price)]


def test_a_list_is_pickled(price):
    other = pickle.loads(pickle.dumps(price))
    assert str(other) == str(price) and other.predict(1e-6).seconds == price.predict(1e-6).seconds
    assert str(pickle.loads(pickle.dumps(price.predict(1e-6)))) == str(price.predict(1e-6))


def test_a_list_is_a_data_frame(price):
    frame = price.to_pandas()
    assert len(frame) == len(price) and frame.attrs["reference"] == price.reference
    best = frame[frame.error <= 1e-8].sort_values("seconds").iloc[0]
    assert best.engine == price.cheapest(1e-8).engine
    assert frame.on_front.sum() == len(price.front()) and set(frame[frame.is_automatic].engine) == {"taylor"}


def test_a_list_is_a_table_in_notebooks(price):
    text = price._repr_html_()
    assert text == price_html(price)
    assert text.count("<tr") == 1 + len(price) and text.count("font-weight: bold") == len(price.front())
    assert "taylor (auto)" in text and "closed form: cannot" in text


def labels_of(axes):
    return [line.get_label() for line in axes.lines if not line.get_label().startswith("_")]


@pytest.mark.cvode
def test_the_work_precision_diagram_has_a_line_an_engine(price, tmp_path):
    figure = price.plot(tmp_path / "price.png")
    (axes,) = figure.axes
    assert labels_of(axes) == ["cheapest", "taylor (auto)", "dop853", "cvode-adams", "cvode-bdf"]
    dashed = [line for line in axes.lines if line.get_linestyle() == "--"]
    assert len(dashed) == len(ENGINES)
    # the legend is outside the axes
    figure.canvas.draw()
    (legend,) = figure.legends
    assert not legend.get_window_extent().overlaps(axes.get_window_extent())
    assert (tmp_path / "price.png").stat().st_size > 10_000


def test_events_stand_apart_in_the_diagram():
    figure = rb.cost(near_graze()[0], until=4.0, engines=["taylor"]).plot()
    motion, events = figure.axes
    assert "motion" in motion.get_xlabel() and "events" in events.get_xlabel()


def test_statistics_tell_where_the_time_of_a_run_went():
    scene = orbit()[0]
    first = rb.simulate(scene, 20.0, error=1e-9).statistics
    parts = first.planning_seconds + first.integration_seconds + first.judging_seconds
    assert min(first.planning_seconds, first.integration_seconds, first.judging_seconds) > 0
    assert parts == pytest.approx(first.seconds, rel=1e-9)
    assert "planning" in str(first) and "judging" in str(first)
    # without an estimate nothing is judged
    cheap = rb.simulate(scene, 20.0, rtol=1e-9).statistics
    assert cheap.judging_seconds == 0 and cheap.integration_seconds <= cheap.seconds


def test_progress_is_the_share_of_the_budget_that_is_spent():
    fractions = []
    rb.cost(orbit()[0], until=2000.0, budget=0.5, progress=fractions.append)
    assert len(fractions) > 2 and fractions[-1] == 1.0
    assert all(0 <= one <= 2 for one in fractions) and fractions[:-1] == sorted(fractions[:-1])


def test_what_a_function_raises_arrives_unchanged():
    class Enough(Exception):
        pass

    def force(t, r, v):
        if t > 0.5:
            raise Enough
        return [-float(r[0]), 0, 0]

    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.apply(rb.Force(force), ball)
    with pytest.raises(Enough):
        rb.cost(scene, until=2.0)


@pytest.mark.cvode
def test_a_closed_form_too_long_to_step_along_leaves_the_others_out():
    price = rb.cost(oscillator()[0], until=1e9, budget=0.5)
    assert {row.engine for row in price} == {"closed form"}
    assert all(reasons(price)[engine].startswith("no time left") for engine in ENGINES)
