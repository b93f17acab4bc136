"""Long chains of hinged links against equations written down here: links as bodies apart, held by unknown forces.

With u_i the unit vector down link i, p_i = du_i/dtheta_i, theta_i its angle against the vertical, F_i the force on it
at its upper hinge and F_n = 0:

    m c_i'' = m g + F_i - F_(i+1),    I theta_i'' = -(l/2) p_i . (F_i + F_(i+1)),
    c_i'' - (l/2) (u_i)'' = c_(i-1)'' + (l/2) (u_(i-1))'',    the hinge at the top at rest,

a band of 2 x 2 blocks for F, solved in time proportional to n. None of it is the recursion of the library.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, solve_banded

GRAVITY = np.array([0.0, -9.81])  # along x and z
EPSILON = np.finfo(float).eps


def chain(angles, rates):
    """1 m and 1 kg in all; angles and rates against the vertical."""
    n = len(angles)
    scene, length = rb.Scene(gravity=[0, 0, -9.81]), 1.0 / n
    across = length**2 / (12 * n)
    rod = rb.RigidBody(mass=1.0 / n, inertia=[across, across, across])
    links, last = [], {}
    for i, (angle, rate) in enumerate(zip(np.diff(angles, prepend=0.0), np.diff(rates, prepend=0.0), strict=True)):
        hinge = rb.Revolute(axis=[0, 1, 0], at=[0, 0, -length / 2 if i else 0.0], point=[0, 0, length / 2])
        links.append(scene.add(rod, hinge, angle=angle, rate=rate, **last))
        last = {"parent": links[-1]}
    return scene, links


def accelerations(angles, rates):
    """theta'' and F."""
    n = len(angles)
    mass, length = 1.0 / n, 1.0 / n
    inertia = mass * length**2 / 12
    down = np.stack([-np.sin(angles), -np.cos(angles)], axis=1)
    across = np.stack([-np.cos(angles), np.sin(angles)], axis=1)
    turning = (length**2 / (4 * inertia)) * across[:, :, None] * across[:, None, :]
    falling = np.eye(2) / mass
    inward = 0.5 * length * (rates**2)[:, None] * down
    # rows of hinge i: of F_(i-1), of F_i, of F_(i+1)
    above = np.concatenate([np.zeros((1, 2, 2)), turning[:-1] - falling])
    here = turning + falling
    here[1:] += turning[:-1] + falling
    below = turning - falling
    right = -inward
    right[1:] -= inward[:-1]
    right[0] -= GRAVITY
    band = np.zeros((7, 2 * n))
    for row in range(2):
        for column in range(2):
            shift = row - column
            band[3 + shift, column::2] = here[:, row, column]
            band[3 + shift - 2, 2 + column :: 2] = below[:-1, row, column]
            band[3 + shift + 2, column : 2 * n - 2 : 2] = above[1:, row, column]
    force = solve_banded((3, 3), band, right.ravel()).reshape(n, 2)
    both = force + np.concatenate([force[1:], np.zeros((1, 2))])
    return -(0.5 * length / inertia) * np.einsum("ij,ij->i", across, both), force


def centres(angles):
    length = 1.0 / len(angles)
    down = length * np.stack([-np.sin(angles), -np.cos(angles)], axis=1)
    return np.cumsum(down, axis=0) - 0.5 * down


def bent(n):
    place = np.arange(n) / n
    return 0.8 + 0.5 * np.sin(7.0 * place), 2.0 * np.cos(5.0 * place)


@pytest.mark.parametrize("n", [2, 30, 100])
def test_a_bent_chain_falls_as_an_integration_of_its_hinge_forces_says(n):
    angles, rates = bent(n)
    scene, links = chain(angles, rates)
    until, error = 0.05, 1e-9
    run = rb.simulate(scene, until, error=error)
    assert run.error <= error

    def rate(_, y):
        return np.concatenate([y[n:], accelerations(y[:n], y[n:])[0]])

    start = np.concatenate([angles, rates])
    y = solve_ivp(rate, (0.0, until), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    expected, began = centres(y[:n]), centres(angles)
    found = np.array([run[link].position(until) for link in links])[:, [0, 2]]
    moved = np.linalg.norm(expected - began, axis=1).max()
    assert moved > 0.01
    assert np.linalg.norm(found - expected, axis=1).max() <= error * moved


@pytest.mark.parametrize("n", [10, 100, 1000])
def test_accelerations_and_reactions_are_those_of_the_hinge_forces(n):
    scene, links = chain(*bent(n))
    until = 1e-3
    run = rb.simulate(scene, until, rtol=1e-11, keep="end")
    angles = np.cumsum([run[link].angle(until) for link in links])
    rates = np.cumsum([run[link].rate(until) for link in links])
    turning, force = accelerations(angles, rates)
    # rounding of an angle turns all that hang below it; the band is as badly conditioned as n squared
    allowed = 16 * EPSILON * n**2
    found = np.array([run[link].angular_acceleration(until) for link in links])
    assert np.abs(found[:, 1] - turning).max() <= allowed * np.abs(turning).max()
    assert not found[:, [0, 2]].any()
    reaction = np.array([run[link].reaction(until) for link in links])[:, [0, 2]]
    assert np.abs(reaction - force).max() <= allowed * np.abs(force).max()


def test_a_chain_of_300_swings_as_its_normal_modes_say():
    # m l^2 (n - 1 - max(i, j) + 1/2) theta_j'' (1/3 where i = j), m g l (n - 1 - i + 1/2) theta_i
    n, until, amplitude = 300, 0.05, 1e-4
    mass = length = 1.0 / n
    index = np.arange(n)
    hanging = n - 1 - np.maximum.outer(index, index)
    masses = mass * length**2 * (hanging + np.where(np.eye(n, dtype=bool), 1 / 3, 1 / 2))
    stiffness = np.diag(-mass * GRAVITY[1] * length * (n - 1 - index + 0.5))
    squares, modes = eigh(stiffness, masses)
    rates = amplitude * np.exp(-(((index - 40) / 10.0) ** 2))
    frequencies = np.sqrt(squares)
    expected = modes @ (np.sin(frequencies * until) / frequencies * (modes.T @ masses @ rates))
    scene, links = chain(np.zeros(n), rates)
    # by angles: of places of a metre, these motions are too near to rounding for error=
    run = rb.simulate(scene, until, rtol=1e-12, keep="end")
    found = np.cumsum([run[link].angle(until) for link in links])
    # a hundred times the local tolerance; at these angles sin(theta) is theta to 1e-11
    assert np.abs(found - expected).max() <= 1e-10 * np.abs(expected).max()
