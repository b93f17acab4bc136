"""Smooth boxes on each other, of masses from a gram to a tonne, each on its four lower corners: those that stand stand,
and those that tip begin as Gauss's principle of least constraint says. By non-negative least squares, which share
nothing with the library's problem.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.optimize import nnls

G = 9.81


class Column:
    def __init__(self, seed):
        draw, gravity = np.random.default_rng(seed), [0, 0, -G]
        self.scene, self.bodies, self.contacts = rb.Scene(gravity=gravity), [], []
        count, places, widths, masses, rows, x, z = int(draw.integers(2, 7)), [], [], [], [], 0.0, 0.0
        top = rb.Plane([0, 0, 1])
        self.weights = []  # masses and moments of inertia
        for k in range(count):
            m, (b, d, h) = 10 ** draw.uniform(-3, 3), draw.uniform(0.1, 0.6, 3)
            aside = 0.0 if draw.integers(2) else draw.uniform(-1.1, 1.1) * min(b, widths[-1] if widths else b)
            x += aside if k else 0.0
            body = self.scene.add(rb.shapes.box(m, [b, d, h]), position=[x, 0, z + h / 2])
            places.append(np.array([x, 0, z + h / 2]))
            for place in ([s * b / 2, u * d / 2, -h / 2] for s in (-1, 1) for u in (-1, 1)):
                self.contacts.append(self.scene.contact(body.point(place), top))
                row, up = np.zeros(6 * count), np.array([0, 0, 1.0])
                for i, sign in ((k, 1), (k - 1, -1)) if k else ((k, 1),):
                    arm = places[k] + place - places[i]
                    row[6 * i : 6 * i + 6] = sign * np.r_[up, np.cross(arm, up)]
                rows.append(row)
            self.weights += [m, m, m, *(m / 12 * np.array([d**2 + h**2, b**2 + h**2, b**2 + d**2]))]
            self.bodies.append(body)
            widths.append(b)
            masses.append(m)
            top, z = body.plane([0, 0, 1], [0, 0, h / 2]), z + h
        self.rows = np.array(rows)
        # of what is above each box, itself included, how far its centre of mass is inside its feet
        above = [np.average([p[0] for p in places[k:]], weights=masses[k:]) - places[k][0] for k in range(count)]
        self.margin = min(b / 2 - abs(a) for a, b in zip(above, widths, strict=True))

    def accelerations(self):
        """Of those that open no gap below zero the nearest to free fall, in the metric of the masses."""
        roots, free = np.sqrt(self.weights), np.zeros(len(self.weights))
        free[2::6] = -G
        across = (self.rows / roots).T
        sizes = np.linalg.norm(across, axis=0)
        forces, _ = nnls(across / sizes, -roots * free, maxiter=10000)
        return free + self.rows.T @ (forces / sizes) / self.weights


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_a_column_of_boxes_stands_or_begins_to_tip_as_it_must(first):
    counts = [0, 0]
    for seed in range(first, first + 20):
        column = Column(seed)
        if abs(column.margin) < 1e-3:
            continue
        stands = int(column.margin > 0)
        counts[stands] += 1
        if stands:
            run = rb.simulate(column.scene, 100.0, error=1e-9)
            assert not len(run.events), seed
            for body in column.bodies:
                assert (run[body].position(100.0) == run[body].position(0.0)).all(), seed
            continue
        run, exact = rb.simulate(column.scene, 1e-6, rtol=1e-10), column.accelerations()
        told = [np.r_[run[body].acceleration(1e-7), run[body].angular_acceleration(1e-7)] for body in column.bodies]
        assert np.abs(np.concatenate(told) - exact).max() < 1e-6 * max(G, np.abs(exact).max()), seed
    assert min(counts) > 3


@pytest.mark.parametrize("seed", [80, 152, 166])
def test_columns_of_boxes_that_tip_go_on(seed):
    """What slides off and what rides along while they do changes which feet bear it: they went on switching."""
    column, until = Column(seed), 0.05
    run = rb.simulate(column.scene, until, error=1e-9)
    t = np.linspace(0, until, 51)
    energy = run.energy(t)
    assert np.diff(energy).max() <= 1e-11 * np.abs(energy).max()
    for contact in column.contacts:
        assert run[contact].gap(t).min() > -1e-12
        assert run[contact].force(t)[:, 2].min() > -1e-9 * run[contact].force(t)[:, 2].max(initial=1.0)
