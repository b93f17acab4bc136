"""Systems: forces between bodies, their theorems, first integrals and normal modes."""

import json
import pickle

import numpy as np
import pytest
import rbdyn as rb


@pytest.fixture
def three():
    """Three particles, a damper between two of them, under gravity."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    bodies = [scene.add(rb.Particle(mass=1.0 + i), position=[i, i * i, -i], velocity=[1 - i, i, 0.5]) for i in range(3)]
    scene.connect(rb.Spring(stiffness=30.0, rest_length=1.0, damping=0.5), bodies[0], bodies[1])
    scene.connect(rb.Gravitation(constant=1.0), bodies[0], bodies[2])
    scene.connect(rb.Central(lambda r: 2.0 / (1.0 + r**2)), bodies[1], bodies[2])
    return scene, bodies


def test_the_theorems_hold_about_poles_of_every_kind(three):
    scene, bodies = three
    run = rb.simulate(scene, until=2.0, error=1e-11)
    t = np.linspace(0, 2, 41)

    def path(time):
        return np.array([np.sin(time), np.cos(2 * time), 0.3 * time])

    for pole in (path, [1.0, 2.0, 3.0], bodies[1], np.array([0.5, 0.0, 0.0])):
        for of in (None, bodies[0], bodies[1:]):
            first, second = run.cardinal_residuals(t, pole=pole, of=of)
            assert first.shape == second.shape == (41, 3)
            assert abs(first).max() < 1e-12 and abs(second).max() < 1e-11
    # the same pole as places, and as a function that cannot be recorded
    places = np.stack([np.sin(t), np.cos(2 * t), 0.3 * t], axis=1)
    about = run.angular_momentum(t, pole=path)
    assert np.allclose(run.angular_momentum(t, pole=places), about, rtol=0, atol=1e-13)
    called = run.angular_momentum(t, pole=lambda time: [float(np.sin(time)), float(np.cos(2 * time)), 0.3 * time])
    assert np.allclose(called, about, rtol=0, atol=1e-13)
    K = sum((i + 1) * np.cross(run[b].position(t) - places, run[b].velocity(t)) for i, b in enumerate(bodies))
    assert np.allclose(about, K, rtol=0, atol=1e-12)
    assert run.angular_momentum(0.5, pole=[0.0, 0.0, 1.0]).shape == (3,)
    with pytest.raises(rb.InvalidInput, match="the velocity of the pole is not known"):
        run.cardinal_residuals(t, pole=places)
    with pytest.raises(rb.InvalidInput, match=r"pole has shape \(2, 3\)"):
        run.angular_momentum(t, pole=np.zeros((2, 3)))


def test_energies_are_seen_from_the_axes_asked_for(three):
    scene, bodies = three
    run = rb.simulate(scene, until=2.0, error=1e-11)
    t = np.linspace(0, 2, 11)
    T, T_G = run.kinetic_energy(t), run.kinetic_energy(t, frame="center of mass")
    assert np.allclose(T, T_G + 0.5 * 6.0 * (run.center_of_mass_velocity(t) ** 2).sum(1), rtol=1e-14)
    moved = run.kinetic_energy(t, pole=bodies[0])
    v0 = run[bodies[0]].velocity(t)
    by_hand = sum(0.5 * (i + 1) * ((run[b].velocity(t) - v0) ** 2).sum(1) for i, b in enumerate(bodies))
    assert np.allclose(moved, by_hand, rtol=1e-13)
    assert np.allclose(run.kinetic_energy(t, of=bodies[0], frame="center of mass"), 0.0, atol=1e-28)
    # parts: the couplings among them, and what is theirs alone
    parts = sum(run.potential_energy(t, of=b) for b in bodies)
    pairs = run.potential_energy(t) - parts
    distance = np.linalg.norm(run[bodies[0]].position(t) - run[bodies[2]].position(t), axis=1)
    of_two = run.potential_energy(t, of=[bodies[0], bodies[2]]) - sum(
        run.potential_energy(t, of=bodies[i]) for i in (0, 2)
    )
    assert np.allclose(of_two, -3.0 / distance, rtol=1e-12)
    assert not np.allclose(pairs, of_two)
    for wrong in ({"frame": "body"}, {"frame": "world", "pole": [0, 0, 0]}):
        with pytest.raises(rb.InvalidInput, match="frame"):
            run.kinetic_energy(t, **wrong)


def test_external_forces_leave_out_those_within(three):
    scene, bodies = three
    run = rb.simulate(scene, until=1.0)
    weight = np.array([0.0, 0.0, -9.81])
    assert np.allclose(run.external_force(0.5), 6.0 * weight, rtol=1e-15)
    spring, attraction, push = run.couplings
    outside = weight + run[spring].force(0.5) + run[attraction].force(0.5)
    assert np.allclose(run.external_force(0.5, of=bodies[0]), outside, rtol=1e-14)
    both = 3.0 * weight + run[attraction].force(0.5) + run[push].force(0.5)
    assert np.allclose(run.external_force(0.5, of=bodies[:2]), both, rtol=1e-14)
    G = run.center_of_mass(0.5)
    assert np.allclose(run.external_moment(0.5), np.cross(G, 6.0 * weight), rtol=1e-13)
    assert np.allclose(run.external_moment(0.5, pole=G), 0.0, atol=1e-13)


def test_forces_between_bodies_are_data_and_come_by_any_way():
    def law(t, r_a, r_b, v_a, v_b):
        return (r_b - r_a) * (1.0 + 0.1 * np.sin(t)) - 0.1 * (v_a - v_b)

    ends = []
    for trace in (True, False):
        scene = rb.Scene()
        a = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 1, 0])
        b = scene.add(rb.Particle(2.0), position=[0, 0, 1])
        pair = scene.connect(rb.PairForce(law, trace=trace), a, b)
        central = scene.connect(rb.Central(lambda r: 1.0 / r**2, trace=trace), a, b)
        assert [h.name for h in scene.couplings] == ["pair force 1", "central force 2"]
        run = rb.simulate(scene, until=2.0, error=1e-11, engine="dop853")
        assert (run.statistics.python_calls == 0) == trace
        assert run.plan.effects == ["central force", "user force"]
        assert np.array_equal(run[a].force(1.0), -run[b].force(1.0))
        assert np.allclose(run[a].force(1.0), run[pair].force(1.0) + run[central].force(1.0), rtol=1e-15)
        distance = np.linalg.norm(run[a].position(1.0) - run[b].position(1.0))
        # numpy's norm is rounded as the processor adds
        assert np.allclose(run[central].length(1.0), distance, rtol=4e-16, atol=0.0)
        ends.append(run[a].position(2.0))
        if trace:
            again = pickle.loads(pickle.dumps(scene))
            assert again == scene
            assert np.array_equal(rb.simulate(again, 2.0, error=1e-11, engine="dop853")[a].position(2.0), ends[0])
            assert rb.simulate(scene.without("user force", central), 1.0).plan.effects == []
    assert np.allclose(*ends, rtol=0, atol=1e-10)
    assert rb.Gravitation(2.0) == rb.Gravitation(constant=2.0) != rb.Gravitation(3.0)
    assert repr(rb.Gravitation(2.0)) == "Gravitation(constant=2)"
    with pytest.raises(rb.InvalidInput, match="connect a Central"):
        scene.connect(rb.Gravitation(1.0), a, [0, 0, 0])
    with pytest.raises(rb.InvalidInput, match="three components"):
        rb.PairForce(lambda t, r_a, r_b, v_a, v_b: 1.0)


@pytest.mark.parametrize("name", ["o_pleiades", "o_figure_eight"])
@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
def test_particles_attract_each_other_as_the_reference_digits_say(name, error, reference):
    case = json.loads((reference / f"{name}.json").read_text())
    p = case["parameters"]

    def space(numbers):
        return [float(x) for x in numbers] + [0.0] * (3 - len(numbers))

    scene = rb.Scene()
    bodies = [
        scene.add(rb.Particle(float(m)), position=space(r), velocity=space(v))
        for m, r, v in zip(p["mass"], p["position0"], p["velocity0"], strict=True)
    ]
    for i, a in enumerate(bodies):
        for b in bodies[:i]:
            scene.connect(rb.Gravitation(float(p["constant"]["value"])), b, a)
    last = case["values"]["samples"][-1]
    run = rb.simulate(scene, until=float(last["t"]), error=error)
    for body, place in zip(bodies, last["position"], strict=True):
        assert np.linalg.norm(run[body].position(run.end) - space(place)) < 10 * run.error + 1e-12
    assert set(run.drift) == {"energy", "momentum x", "momentum y", "momentum z", "angular momentum"}


def test_bodies_that_meet_end_the_run_by_name_and_time():
    scene = rb.Scene()
    a = scene.add(rb.Particle(1.0), position=[-1, 0, 0], name="sun")
    b = scene.add(rb.Particle(2.0), position=[1, 0, 0], name="planet")
    scene.connect(rb.Gravitation(1.0), a, b)
    with pytest.raises(rb.IntegrationError, match="gravitation of sun and planet.*they meet") as caught:
        rb.simulate(scene, until=10.0)
    assert caught.value.run.status == "not finite"
    assert caught.value.run.end == pytest.approx(np.pi * np.sqrt(8.0 / 24.0), rel=1e-8)


def test_normal_modes_are_those_of_the_pencil():
    k1, k2, k, m1, m2 = 7.0, 11.0, 3.0, 1.5, 0.5
    scene = rb.Scene(gravity=[0, 0, -9.81])
    rail = rb.Rail(rb.Line(direction=[1, 0, 0]))
    one = scene.add(rb.Particle(m1), rail, parameter=1.0)
    two = scene.add(rb.Particle(m2), rail, parameter=-0.5)
    scene.connect(rb.Spring(k1), one, [0, 0, 0])
    scene.connect(rb.Spring(k2, damping=0.1), two, [0, 0, 0])
    scene.connect(rb.Spring(k), one, two)
    modes = rb.normal_modes(scene, at=rb.equilibria(scene, near=[0.1, 0.1])[0])
    M, K = np.diag([m1, m2]), np.array([[k1 + k, -k], [-k, k2 + k]])
    assert np.allclose(modes.squares, np.sort(np.linalg.eigvals(np.linalg.inv(M) @ K)), rtol=1e-14)
    assert np.allclose(modes.frequencies**2, modes.squares, rtol=1e-15)
    assert np.allclose(modes.shapes.T @ M @ modes.shapes, np.eye(2), rtol=0, atol=1e-15)
    assert np.allclose(modes.shapes.T @ K @ modes.shapes, np.diag(modes.squares), rtol=0, atol=1e-13)
    assert pickle.loads(pickle.dumps(modes)) == modes and "rad/s" in str(modes)
    # upside down
    scene = rb.Scene(gravity=[0, 0, -9.81])
    scene.add(rb.shapes.rod(1.0, 1.0, [0, 0, 1]), rb.Revolute([0, 1, 0], point=[0, 0, -0.5]))
    modes = rb.normal_modes(scene, at=[e for e in rb.equilibria(scene) if not e.stable][0])
    assert np.isnan(modes.frequencies[0]) and modes.squares[0] == pytest.approx(-1.5 * 9.81, rel=1e-14)
    assert "unstable" in str(modes)
    other = rb.Scene()
    other.add(rb.Particle(1.0))
    with pytest.raises(rb.InvalidInput, match="number of coordinates"):
        rb.normal_modes(other, rb.equilibria(scene)[0])
