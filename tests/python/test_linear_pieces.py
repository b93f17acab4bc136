"""Scenes that are linear between changes of their formula, against series and SciPy: rows of springs with lengths."""

import numpy as np
import pytest
import rbdyn as rb
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import solve_ivp

TIMES = np.linspace(0.0, 7.0, 71)


class Row:
    """Masses in a row below the origin, each on a spring of its own rest length to the one before."""

    def __init__(self, seed, *, swing):
        random = np.random.default_rng(seed)
        count = int(random.integers(1, 6))
        self.masses = random.uniform(0.5, 3.0, count)
        self.stiffness = random.uniform(5.0, 80.0, count)
        self.rest = random.uniform(0.3, 1.5, count)
        self.weight = float(random.choice([0.0, 9.8125]))
        self.places = -np.cumsum(self.rest * random.uniform(0.9, 1.1, count))
        self.speeds = swing * random.uniform(-1.0, 1.0, count)

    def scene(self):
        scene = rb.Scene(gravity=[0, 0, -self.weight])
        before = [0, 0, 0]
        for mass, stiffness, rest, place, speed in zip(
            self.masses, self.stiffness, self.rest, self.places, self.speeds, strict=True
        ):
            ball = scene.add(rb.Particle(mass), position=[0, 0, place], velocity=[0, 0, speed])
            scene.connect(rb.Spring(stiffness, rest_length=rest), ball, before)
            before = ball
        return scene

    def slopes(self, _, state):
        z, v = np.split(state, 2)
        apart = np.diff(z, prepend=0.0)
        pull = -self.stiffness * (apart - self.rest * np.sign(apart))
        return np.concatenate([v, (pull - np.append(pull[1:], 0.0)) / self.masses - self.weight])

    def lengths_cross(self, run):
        z = heights(run)
        return (np.diff(np.sign(np.diff(z, axis=0, prepend=np.zeros((1, z.shape[1])))), axis=1) != 0).any()


def heights(run, times=TIMES):
    return np.array([run[body].position(times)[:, 2] for body in run.bodies])


@pytest.mark.parametrize("seed", range(20))
def test_what_keeps_its_formula_is_in_closed_form_at_any_length(seed):
    row = Row(seed, swing=0.05)
    run = rb.simulate(row.scene(), 7.0, error=1e-12)
    whole = solve_ivp(row.slopes, (0, 7), [*row.places, *row.speeds], "DOP853", TIMES, rtol=1e-13, atol=1e-14).y
    assert_allclose(heights(run), whole[: len(row.masses)], atol=3e-11)
    series = rb.simulate(row.scene(), 7.0, error=1e-12, engine="taylor")
    assert_allclose(heights(run), heights(series), atol=1e-12)
    if run.engine == "closed form":
        assert run.statistics.steps == 0 and not row.lengths_cross(run)
        far = rb.simulate(row.scene(), 7e5, error=1e-9)
        assert far.statistics.steps == 0
        assert_array_equal(heights(far), heights(run))


def test_most_rows_that_hardly_swing_are():
    engines = [rb.plan(Row(seed, swing=0.05).scene()).engine for seed in range(20)]
    assert engines.count("closed form") >= 10


@pytest.mark.parametrize("seed", range(20))
def test_what_changes_its_formula_is_by_series_and_by_pieces_where_asked(seed):
    row = Row(seed, swing=12.0)
    run = rb.simulate(row.scene(), 7.0, error=1e-10)
    assert run.engine == "taylor" or not row.lengths_cross(run)
    pieces = rb.simulate(row.scene(), 7.0, error=1e-10, engine="closed form")
    series = rb.simulate(row.scene(), 7.0, error=1e-12, engine="taylor")
    size = np.abs(heights(series)).max()
    assert np.abs(heights(pieces) - heights(series)).max() <= size * (pieces.error + series.error)
    assert [e.kind for e in pieces.events] == [e.kind for e in series.events]
    assert_allclose([e.time for e in pieces.events], [e.time for e in series.events], rtol=0, atol=1e-11)
    for keep in ("end", [2.0, 3.5]):
        other = rb.simulate(row.scene(), 7.0, error=1e-10, engine="closed form", keep=keep)
        kept = np.array([7.0] if keep == "end" else keep)
        assert_array_equal(heights(other, kept), heights(pieces, kept))


@pytest.mark.parametrize("swing", [0.05, 12.0])
def test_it_goes_on_and_comes_back_from_its_file(swing, tmp_path):
    row = Row(3, swing=swing)
    for engine in ("auto", "closed form"):
        try:
            whole = rb.simulate(row.scene(), 7.0, error=1e-9, engine=engine)
        except rb.InvalidInput:
            continue
        first = rb.simulate(row.scene(), 3.0, error=1e-9, engine=engine)
        first.save(tmp_path / "run.npz")
        on = rb.simulate(rb.load(tmp_path / "run.npz"), until=7.0)
        late = TIMES[TIMES >= 3.0]
        assert on.error <= 1e-9
        assert_allclose(heights(on, late), heights(whole, late), atol=1e-9)


def test_which_it_is_follows_from_the_start():
    scene = Row(3, swing=0.05).scene()
    assert rb.plan(scene).engine == "closed form"
    fast = {(body, "velocity"): [0, 0, 15.0 * (-1) ** k] for k, body in enumerate(scene.bodies)}
    for _ in range(2):
        assert rb.simulate(scene, 1.0, error=1e-9).engine == "closed form"
        assert rb.simulate(scene, 1.0, error=1e-9, initial=fast).engine == "taylor"


def test_watched_functions_are_found_on_it():
    row = Row(3, swing=0.05)
    scene = row.scene()
    last = scene.bodies[-1]
    level = float(np.mean(heights(rb.simulate(scene, 7.0, error=1e-12))[-1]))
    scene.watch("level", lambda now: now[last].position[2] - level)
    run = rb.simulate(scene, 7.0, error=1e-10)
    assert run.engine == "closed form"
    series = rb.simulate(scene, 7.0, error=1e-12, engine="taylor")
    assert len(run.events) > 3
    assert_allclose(run.events.times("level"), series.events.times("level"), atol=1e-12)


def test_how_far_it_is_certain_is_told():
    """Two masses that swing through each other, which is chaotic."""
    scene, before = rb.Scene(gravity=[-9.81, 0, 0]), [0, 0, 0]
    for mass, stiffness, rest, place, speed in zip(
        [0.838, 1.952], [58.75, 25.99], [0.701, 0.488], [1.358, 0.343], [-1.044, -3.609], strict=True
    ):
        ball = scene.add(rb.Particle(mass), position=[place, 0, 0], velocity=[speed, 0, 0])
        scene.connect(rb.Spring(stiffness, rest_length=rest), ball, before)
        before = ball
    certain = []
    for engine in ("closed form", "taylor"):
        with pytest.raises(rb.AccuracyError) as failure:
            rb.simulate(scene, 400.0, error=1e-8, engine=engine)
        certain.append(failure.value.run.certain_until)
    # as far as where they are still alike
    assert 100.0 < min(certain) and abs(certain[0] - certain[1]) < 100.0
    near = 0.8 * min(certain)
    ends = [rb.simulate(scene, near, error=1e-8, engine=engine) for engine in ("closed form", "taylor")]
    assert_allclose(heights_of(ends[0], near), heights_of(ends[1], near), atol=1e-7)


def heights_of(run, time):
    return [run[body].position(time)[0] for body in run.bodies]


def test_a_price_list_has_it():
    price = rb.cost(Row(3, swing=12.0).scene(), 5.0, errors=[1e-6, 1e-9], engines=["closed form", "taylor"], budget=2.0)
    assert {row.engine for row in price} == {"closed form", "taylor"}
    assert all(row.error < 1e-9 for row in price if row.engine == "closed form")
