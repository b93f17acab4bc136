"""Driven four-bars of bars of any masses: their motion is geometry, and the force of their pin follows from it by the
balances of moments, both in closed form here."""

import numpy as np
import pytest
import rbdyn as rb

CRANK, COUPLER, ROCKER, BASE = 0.75, 2.0, 1.5, 2.0
G = np.array([0, -9.81])


def driven(masses):
    def bar(mass, length, moment):
        return rb.RigidBody(mass, [moment] * 3, com=[length / 2, 0, 0])

    scene = rb.Scene(gravity=[*G, 0])
    turn = lambda t: 0.5 + 2 * t + 0.3 * np.sin(3 * t)  # noqa: E731
    crank = scene.add(bar(masses[0], CRANK, 0.05), rb.Revolute([0, 0, 1], motion=turn))
    hinge = rb.Revolute([0, 0, 1], at=[CRANK, 0, 0])
    coupler = scene.add(bar(masses[1], COUPLER, 0.7 * masses[1]), hinge, parent=crank, angle=0.1)
    rocker = scene.add(bar(masses[2], ROCKER, 0.3 * masses[2]), rb.Revolute([0, 0, 1], at=[BASE, 0, 0]), angle=1.4)
    pin = scene.constrain(rb.Ball(), coupler.point([COUPLER, 0, 0]), rocker.point([ROCKER, 0, 0]))
    scene.assemble(keep=[crank])
    return scene, coupler, rocker, pin


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def geometry(t, masses, tip):
    """Angles, rates and accelerations of coupler and rocker, and the force of the pin on the coupler."""
    along, across = lambda a: np.array([np.cos(a), np.sin(a)]), lambda a: np.array([-np.sin(a), np.cos(a)])
    angle, rate, rush = 0.5 + 2 * t + 0.3 * np.sin(3 * t), 2 + 0.9 * np.cos(3 * t), -2.7 * np.sin(3 * t)
    end = CRANK * along(angle)
    to = np.array([BASE, 0]) - end
    d = np.hypot(*to)
    part = (COUPLER**2 - ROCKER**2 + d**2) / (2 * d)
    height = np.sqrt(COUPLER**2 - part**2) * np.array([-to[1], to[0]]) / d
    pin = min((end + part * to / d + side * height for side in (1, -1)), key=lambda p: np.hypot(*(p - tip)))
    k, r = np.arctan2(*(pin - end)[::-1]), np.arctan2(*(pin - [BASE, 0])[::-1])
    # crank + coupler - rocker = base, twice differentiated
    matrix = np.column_stack([COUPLER * across(k), -ROCKER * across(r)])
    rates = np.linalg.solve(matrix, -CRANK * rate * across(angle))
    of_end = CRANK * (rush * across(angle) - rate**2 * along(angle))
    rushes = np.linalg.solve(matrix, -of_end + COUPLER * rates[0] ** 2 * along(k) - ROCKER * rates[1] ** 2 * along(r))
    # moments of the coupler about its hinge, which accelerates, and of the rocker about its own
    to_pin, on = COUPLER * along(k), ROCKER * along(r)
    moments = [
        masses[1] * ((0.7 + COUPLER**2 / 4) * rushes[0] + cross(to_pin / 2, of_end - G)),
        masses[2] * ((0.3 + ROCKER**2 / 4) * rushes[1] - cross(on / 2, G)),
    ]
    force = np.linalg.solve([[-to_pin[1], to_pin[0]], [on[1], -on[0]]], moments)
    return (k, r), rates, rushes, force


@pytest.mark.parametrize(
    "masses",
    [(1, 1, 1), (1, 1, 1e3), (1, 1, 1e6), (1, 1, 1e9), (1e-9, 1, 1e9), (1, 1e-9, 1), (1e9, 1e-9, 1), (1, 1e9, 1)],
)
def test_a_driven_linkage_moves_as_its_geometry_says(masses):
    scene, coupler, rocker, pin = driven(masses)
    # of bars that differ by 1e18 told 3.6e-9: reactions are differences of what the heavy one does
    error = 1e-8 if masses[0] < 1e-6 else 1e-9
    run = rb.simulate(scene, until=6.0, error=error)
    forces = []
    for t in np.linspace(0.1, 6, 30):
        turn = run[rocker].rotation_matrix(t)[:2, 0]
        angles, rates, rushes, force = geometry(t, masses, np.array([BASE, 0]) + ROCKER * turn)
        for body, angle, rate, rush in zip((coupler, rocker), angles, rates, rushes, strict=True):
            assert np.abs(run[body].rotation_matrix(t)[:2, 0] - [np.cos(angle), np.sin(angle)]).max() < 1e-9
            assert abs(run[body].angular_velocity(t)[2] - rate) < 1e-8
            assert abs(run[body].angular_acceleration(t)[2] - rush) < 1e-7
        forces.append((run[pin].force(t)[:2], force))
    largest = max(np.hypot(*force) for _, force in forces)
    assert max(np.hypot(*(told - force)) for told, force in forces) < 1e-9 * largest
