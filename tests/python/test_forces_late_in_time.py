"""Forces of the time since a late start act as those from zero on, and what is told of them is so.

Truth: closed forms in 40 decimal digits. The time since the start, t - start, is exact in doubles; multiplied out, as
b t - b start, it would be rounded as b start is, and so would all of a motion that begins with nothing.
"""

from fractions import Fraction

import numpy as np
import pytest
import rbdyn as rb

G = Fraction(9.81)


def slipped(b, m, mu, since):
    """Place and speed of what breaks away on a rough line under b t, mu_s = mu_d, and when it does."""
    first = Fraction(mu) * Fraction(m) * G / Fraction(b)
    pull, later = Fraction(b) / Fraction(m), since - first
    x = pull * (since**3 / 6 - first**3 / 6 - first**2 * later / 2) - Fraction(mu) * G * later**2 / 2
    return x, pull * (since**2 - first**2) / 2 - Fraction(mu) * G * later, first


def run_of_slip(b, m, mu, start, until, **how):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    bead = scene.add(rb.Particle(m), rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(mu)))
    scene.apply(rb.Force(lambda t, r, v: [b * (t - start), 0, 0]), bead)
    return rb.simulate(scene, until, start=start, **how), bead


def off(found, exact):
    return float(abs(Fraction(float(found)) / exact - 1))


def test_what_breaks_away_late_is_where_it_should():
    start, until = -1000.0, -999.9435857899299
    run, bead = run_of_slip(78.3, 0.555, 0.281, start, until, error=1e-10)
    x, v, _ = slipped(78.3, 0.555, 0.281, Fraction(until) - Fraction(start))
    assert off(run[bead].position(until)[0], x) <= min(run.error, 1e-11)
    assert off(run[bead].velocity(until)[0], v) <= min(run.error, 1e-11)


@pytest.mark.parametrize("engine", ["taylor", "dop853"])
@pytest.mark.parametrize("start", [-100.0, -1000.0, 50.0, 1e4])
def test_no_less_is_told_of_a_late_slip_than_it_is_off(start, engine):
    rng = np.random.default_rng(abs(int(start)))
    for _ in range(25):
        mu, b, m = float(rng.uniform(0.2, 1)), float(10 ** rng.uniform(-1, 2)), float(10 ** rng.uniform(-1, 1))
        until = start + mu * m * 9.81 / b * float(rng.uniform(1.02, 3))
        try:
            run, bead = run_of_slip(b, m, mu, start, until, error=1e-5, engine=engine)
        except rb.AccuracyError:
            continue
        x, v, _ = slipped(b, m, mu, Fraction(until) - Fraction(start))
        assert off(run[bead].position(until)[0], x) <= run.error
        assert off(run[bead].velocity(until)[0], v) <= run.error


@pytest.mark.parametrize("start", [0.0, -1000.0, 50.0, 1e4])
def test_a_force_that_swings_since_a_late_start_has_its_phase(start):
    b, m, w = 0.293, 1.46, 22.1
    scene = rb.Scene()
    bead = scene.add(rb.Particle(m), rb.Rail(rb.Line([1, 0, 0])))
    scene.apply(rb.Force(lambda t, r, v: [b * np.cos(w * (t - start)), 0, 0]), bead)
    run = rb.simulate(scene, start + 30, start=start, error=1e-9)
    since = np.linspace(0.1, 30, 50)
    times = start + since
    phase = w * (times - start)
    # the exact product, for phases of up to 663 rad
    rest = np.array(
        [float(Fraction(w) * (Fraction(t) - Fraction(start)) - Fraction(p)) for t, p in zip(times, phase, strict=True)]
    )
    place = b / m / w**2 * (2 * np.sin(phase / 2) ** 2 + np.sin(phase) * rest)
    assert run.engine == "closed form"
    assert abs(run[bead].position(times)[:, 0] - place).max() <= 4e-15 * 2 * b / m / w**2
    assert run.error < 5e-15
