"""Equilibria and potentials along rails, from Python."""

import math

import numpy as np
import pytest
import rbdyn as rb

CIRCLE = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])


def hoop(**rail):
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    bead = scene.add(rb.Particle(mass=0.7), rb.Rail(CIRCLE, **rail))
    return scene, bead


def test_a_pendulum_has_two_equilibria():
    scene, _ = hoop()
    below, above = rb.equilibria(scene)
    assert below.coordinates.tolist() == [0.0]
    assert below.stable and not above.stable
    assert below.interval is None
    assert below.periods == pytest.approx([2 * math.pi * math.sqrt(0.5 / 9.8125)], rel=1e-15)
    assert above.coordinates[0] == math.pi
    assert len(above.periods) == 0
    assert repr(above) == "Equilibrium(coordinates=(3.141592653589793,), stable=False, interval=None, periods=())"
    assert str(above) == "Equilibrium at 3.141592653589793, not stable"
    assert below == rb.equilibria(scene, near=1.0)[0] and below != above
    assert len({below, above}) == 2


def test_friction_makes_them_intervals():
    scene, _ = hoop(friction=rb.Coulomb(mu_static=0.4))
    below, above = rb.equilibria(scene)
    assert below.interval == pytest.approx((-math.atan(0.4), math.atan(0.4)), abs=1e-15)
    assert above.stable


def test_several_freedoms_are_searched_from_near():
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    a = scene.add(rb.Particle(mass=2.0), rb.Free(), position=[0.3, 0.1, -1.0])
    scene.connect(rb.Spring(stiffness=50.0, rest_length=1.0), a, [0, 0, 0])
    sag = 2.0 * 9.8125 / 50.0
    (below,) = rb.equilibria(scene)
    assert below.coordinates == pytest.approx([0, 0, -1 - sag], abs=1e-15)
    (above,) = rb.equilibria(scene, near=[0.01, 0.02, 0.7])
    assert above.coordinates == pytest.approx([0, 0, 1 - sag], abs=1e-15)
    assert not above.stable
    with pytest.raises(rb.InvalidInput, match="number of coordinates in near is 2"):
        rb.equilibria(scene, near=[1, 2])
    with pytest.raises(rb.InvalidInput, match="near has shape"):
        rb.equilibria(scene, near=[[1, 2]])


def test_the_potential_of_a_pendulum():
    scene, bead = hoop()
    u = np.linspace(-3.0, 3.0, 7)
    potential = rb.rail_potential(scene, bead)
    assert potential.value(u) == pytest.approx(-0.7 * 9.8125 * 0.5 * (1 - np.cos(u)), abs=1e-15)
    assert potential.tangential_force(u) == pytest.approx(-0.7 * 9.8125 * np.sin(u), abs=1e-15)
    assert isinstance(potential.value(0.3), float)
    assert potential.energy(u, 2.0) == pytest.approx(0.35 * 4.0 - potential.value(u))
    assert potential.energy(0.0, [1.0, 2.0]) == pytest.approx([0.35, 1.4])
    energy = potential.energy(1.0)
    below, above = potential.turning_points(energy, start=0.2)
    assert (below, above) == pytest.approx((-1.0, 1.0), rel=1e-15)
    assert potential.time(energy, below, above) == pytest.approx(0.5 * potential.period(energy, 0.2), rel=1e-15)
    assert potential.speed(1.0, energy) == 0.0
    assert repr(potential) == "<RailPotential: potential of bead 1 along its circle of radius 0.5>"
    round_ = potential.turning_points(potential.energy(0.0, 7.0), 0.0)
    assert round_.below is None and round_.above is None
    assert repr(round_) == "TurningPoints(below=None, above=None)"


def test_a_force_of_position_conserves_energy_along_its_rail():
    scene = rb.Scene()
    bead = scene.add(rb.Particle(mass=0.5), rb.Rail(CIRCLE), parameter=0.4, speed=0.3)
    scene.apply(rb.Force(lambda t, r, v: [-0.75 * r[2] ** 2, 0.0, 0.75 * r[0] * r[2]]), bead)
    assert rb.plan(scene).integrals == ["energy"]
    run = rb.simulate(scene, until=20.0, error=1e-12)
    assert run.drift["energy"] < 1e-13
    potential = rb.rail_potential(scene, bead)
    u = np.array([-3.0, 0.4, 2.0])
    assert potential.work_of_forces(u) == pytest.approx(-0.75 * 0.125 * np.sin(u), abs=1e-15)
    assert run.energy(3.0) == pytest.approx(potential.energy(0.4, 0.3), abs=1e-14)


def test_what_has_no_potential_says_why():
    scene, bead = hoop()
    scene.apply(rb.Drag(linear=0.1), bead)
    with pytest.raises(rb.InvalidInput, match="drag acts on bead 1"):
        rb.rail_potential(scene, bead)
    other, _ = hoop()
    with pytest.raises(rb.InvalidInput, match="another scene"):
        rb.rail_potential(other, bead)
    timed, bead = hoop()
    timed.apply(rb.Force(lambda t, r, v: [np.sin(t), 0, 0]), bead)
    with pytest.raises(rb.InvalidInput, match="depends on time"):
        rb.equilibria(timed)
