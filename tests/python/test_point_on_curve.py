"""Points held on curves, of the world and of bodies: beside rails, closed forms and equations written down apart."""

import pickle

import numpy as np
import pytest
import rbdyn as rb

scipy_integrate = pytest.importorskip("scipy.integrate")
scipy_special = pytest.importorskip("scipy.special")
GRAVITY = 9.8125

CURVES = {
    "line": (rb.Line([1, 2, -1]), 0.25),
    "circle": (rb.Circle(0.5, [0, 0, -1], [1, 0, 0]), 0.75),
    "parabola": (rb.Parabola(0.8, [1, 0, 0], [0, 0, 1]), 0.4),
    "cycloid": (rb.Cycloid(0.3, [1, 0, 0], [0, 0, 1]), 0.9),
    "helix": (rb.Helix(0.4, 0.3, [1, 0, 0], [0, 1, 0]), 1.5),
    "twisted cubic": (rb.Polynomial([[0, 0, 0], [1, 0.25, 0], [0, 0.5, 0.5], [0.1, 0, 0.3]]), 0.3),
    "spline": (rb.Spline([[-2, 0, 1], [-1, 0.2, 0.25], [0, 0, 0], [1, -0.2, 0.25], [2, 0, 1]]), 2.25),
    "function": (rb.Curve(lambda u: [u, 0.3 * np.sin(u), 0.25 * u**2], domain=(-4, 4)), 0.5),
}


@pytest.mark.parametrize("name", CURVES)
def test_a_bead_on_a_curve_moves_as_on_a_rail(name):
    curve, start = CURVES[name]
    guided = rb.Scene(gravity=[0, 0, -GRAVITY])
    bead = guided.add(rb.Particle(0.5), rb.Rail(curve), parameter=start, speed=0.5)
    rail = rb.simulate(guided, until=1.0, error=1e-11)
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    held = scene.add(rb.Particle(0.5), position=rail[bead].position(0.0), velocity=rail[bead].velocity(0.0))
    on = scene.constrain(rb.PointOnCurve(curve), held)
    assert rb.plan(scene).freedom == 1
    run = rb.simulate(scene, until=1.0, error=1e-11)
    t = np.linspace(0.0, 1.0, 11)
    assert run[held].position(t) == pytest.approx(rail[bead].position(t), abs=1e-10)
    assert run[on].force(t) == pytest.approx(rail[bead].reaction(t), abs=1e-8)
    assert run[on].torque(t) == pytest.approx(np.zeros((11, 3)), abs=1e-15)
    assert np.max(run[on].gap(run.t)) < 1e-14


def test_a_bead_on_a_circle_is_a_pendulum_to_twelve_digits():
    length, amplitude = 0.5, 2.0
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    bead = scene.add(rb.Particle(0.5), position=[length * np.sin(amplitude), 0, -length * np.cos(amplitude)])
    scene.constrain(rb.PointOnCurve(rb.Circle(length, [0, 0, -1], [1, 0, 0])), bead)
    run = rb.simulate(scene, until=10.0, error=1e-11)
    t = np.linspace(0.0, 10.0, 41)
    k, rate = np.sin(amplitude / 2), np.sqrt(GRAVITY / length)
    sn, cn, dn, _ = scipy_special.ellipj(scipy_special.ellipk(k**2) - rate * t, k**2)
    angle = 2.0 * np.arcsin(k * sn)
    expected = np.stack([length * np.sin(angle), 0 * t, -length * np.cos(angle)], axis=1)
    assert run[bead].position(t) == pytest.approx(expected, abs=1e-12)


def trammel(gravity, **start):
    scene = rb.Scene(gravity=[0, -gravity, 0])
    rod = rb.RigidBody(1.5, [0.01, 0.5, 0.5])
    bar = scene.add(rod, **start)
    across = scene.constrain(rb.PointOnCurve(rb.Line([1, 0, 0])), bar.point([1, 0, 0]), name="across")
    up = scene.constrain(rb.PointOnCurve(rb.Line([0, 1, 0])), bar.point([-1, 0, 0]), name="up")
    return scene, bar, across, up


def test_a_rod_between_two_lines_draws_an_ellipse():
    # the ends on the axes x and y: the middle on a circle, a quarter point on an ellipse
    angle, rate = 0.7, -2.0
    scene, bar, across, up = trammel(
        0.0,
        position=[np.cos(angle), np.sin(angle), 0],
        velocity=[-rate * np.sin(angle), rate * np.cos(angle), 0],
        attitude=rb.EulerAngles(0, -angle, 0),
        angular_velocity=[0, 0, -rate],
    )
    assert rb.plan(scene).freedom == 2  # and a turn about itself
    run = rb.simulate(scene, until=5.0, error=1e-11)
    t = np.linspace(0.0, 5.0, 21)
    now = angle + rate * t
    assert run[bar].position(t) == pytest.approx(np.stack([np.cos(now), np.sin(now), 0 * t], axis=1), abs=1e-11)
    quarter = run[bar].position(t) + run[bar].rotation_matrix(t) @ [0.5, 0, 0]
    assert (quarter[:, 0] / 1.5) ** 2 + (quarter[:, 1] / 0.5) ** 2 == pytest.approx(np.ones(21), abs=1e-11)
    # Newton's law of the middle, which goes round uniformly
    total = run[across].force(t) + run[up].force(t)
    assert total == pytest.approx(-1.5 * rate**2 * run[bar].position(t), abs=1e-9)
    assert run[across].force(t)[:, 0] == pytest.approx(np.zeros(21), abs=1e-12)


def test_a_point_of_a_pendulum_runs_on_a_parabola():
    steep, arm, mass, inertia = 0.8, 0.4, 1.5, 0.2
    u0, w0, phi0, rate0 = 0.5, 0.3, 0.9, -1.0

    def motion(t, y):
        u, phi, w, rate = y
        along, swing = np.array([1.0, 2 * steep * u]), arm * np.array([np.cos(phi), np.sin(phi)])
        bias = np.array([0.0, 2 * steep * w**2]) + arm * rate**2 * np.array([-np.sin(phi), np.cos(phi)])
        jacobian = np.stack([along, swing])
        matrix = mass * jacobian @ jacobian.T + np.diag([0.0, inertia])
        return [w, rate, *np.linalg.solve(matrix, jacobian @ (mass * (np.array([0, -GRAVITY]) - bias)))]

    reference = scipy_integrate.solve_ivp(
        motion, (0, 2), [u0, phi0, w0, rate0], "DOP853", rtol=1e-13, atol=1e-14, dense_output=True
    )
    scene = rb.Scene(gravity=[0, -GRAVITY, 0])
    body = scene.add(
        rb.RigidBody(mass, [0.1, 0.15, inertia], com=[0, -arm, 0]),
        rb.Planar([1, 0, 0], [0, 1, 0]),
        position=[u0, steep * u0**2],
        velocity=[w0, 2 * steep * u0 * w0],
        angle=phi0,
        rate=rate0,
    )
    on = scene.constrain(rb.PointOnCurve(rb.Parabola(steep, [1, 0, 0], [0, 1, 0])), body.point([0, 0, 0]))
    run = rb.simulate(scene, until=2.0, error=1e-11)
    t = np.linspace(0, 2, 21)
    u, phi, *_ = reference.sol(t)
    assert run[body].position(t) == pytest.approx(np.stack([u, steep * u**2, 0 * t], axis=1), abs=1e-10)
    assert run[body].angle(t) == pytest.approx(phi, abs=1e-10)
    # Newton's law in the plane, and nothing along the curve
    law = mass * (run[body].center_of_mass_acceleration(t) - [0, -GRAVITY, 0])
    assert run[on].force(t)[:, :2] == pytest.approx(law[:, :2], abs=1e-8)
    along = np.stack([np.ones(21), 2 * steep * u], axis=1)
    assert np.sum(run[on].force(t)[:, :2] * along, axis=1) == pytest.approx(np.zeros(21), abs=1e-9)


MOVING = {"slot": rb.Line([1, 0.5, 0], point=[0, 0.1, 0]), "ring": rb.Circle(0.6, [1, 0, 0], [0, 0.6, 0.8])}


@pytest.mark.parametrize("name", MOVING)
def test_a_bead_in_a_slot_of_a_free_body_moves_as_on_its_rail(name):
    curve = MOVING[name]
    plate = rb.RigidBody(2.0, [0.3, 0.5, 0.7], com=[0.1, -0.05, 0.02])
    start = {"velocity": [0.1, 0, 0.2], "attitude": rb.EulerAngles(0.4, 0.3, -0.2), "angular_velocity": [1.0, 0.5, 2.0]}
    guided = rb.Scene()
    carrier = guided.add(plate, **start)
    bead = guided.add(rb.Particle(0.5), rb.Rail(curve), parent=carrier, parameter=0.4, speed=0.3)
    rail = rb.simulate(guided, until=2.0, error=1e-11)
    scene = rb.Scene()
    body = scene.add(plate, **start)
    point = scene.add(rb.Particle(0.5), position=rail[bead].position(0.0), velocity=rail[bead].velocity(0.0))
    on = scene.constrain(rb.PointOnCurve(curve), point, body)
    run = rb.simulate(scene, until=2.0, error=1e-11)
    t = np.linspace(0.0, 2.0, 21)
    assert run[point].position(t) == pytest.approx(rail[bead].position(t), abs=1e-10)
    assert run[body].rotation_matrix(t) == pytest.approx(rail[carrier].rotation_matrix(t), abs=1e-10)
    # on a from b, world axes, and its opposite on b
    assert run[on].force(t) == pytest.approx(0.5 * run[point].acceleration(t), abs=1e-8)
    assert run[on].force(t) == pytest.approx(-2.0 * run[body].center_of_mass_acceleration(t), abs=1e-8)
    assert {"energy", "momentum x", "angular momentum"} <= {
        n if not n.startswith("angular") else "angular momentum" for n in run.drift
    }
    assert max(run.drift.values()) < 1e-11


@pytest.mark.parametrize("engine", ["dop853", "cvode-adams"])
def test_other_engines_agree(engine):
    scene, bar, *_ = trammel(GRAVITY, position=[0.6, 0.8, 0], attitude=rb.EulerAngles(0, -np.arctan2(0.8, 0.6), 0))
    best = rb.simulate(scene, until=0.5, error=1e-11)
    other = rb.simulate(scene, until=0.5, rtol=1e-11, engine=engine)
    assert other[bar].position(0.5) == pytest.approx(best[bar].position(0.5), abs=1e-8)


def test_a_curve_that_ends_stops_the_run_there():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    curve = rb.Curve(lambda u: [0 * u, 0 * u, -(u**2)], domain=(1.0, 2.0))
    bead = scene.add(rb.Particle(1.0), position=[0, 0, -2.0])
    on = scene.constrain(rb.PointOnCurve(curve), bead, name="slot")
    run = rb.simulate(scene, until=5.0, error=1e-11)
    assert run.status == "stopped by event"
    (end,) = run.events
    assert end.kind == "rail-end" and end.name == "slot" and end.subject == bead
    assert end.time == pytest.approx(np.sqrt(4.0 / GRAVITY), abs=1e-11)
    assert run[on].gap(end.time) < 1e-14


def test_a_start_at_an_end_that_is_left_at_once_is_refused():
    curve = rb.Polynomial([[0, 0, 0], [0, 0, -1]], domain=(0.0, 2.0))
    for gravity, refused in ((-GRAVITY, False), (GRAVITY, True), (0.0, False)):
        scene = rb.Scene(gravity=[0, 0, gravity])
        scene.constrain(rb.PointOnCurve(curve), scene.add(rb.Particle(1.0)), name="slot")
        if refused:
            with pytest.raises(rb.InvalidInput, match="slot: it starts at an end of its curve"):
                rb.simulate(scene, until=1.0)
        else:
            rb.simulate(scene, until=0.5)


def test_a_cusp_ends_the_run_by_name():
    cycloid = rb.Cycloid(0.3, [1, 0, 0], [0, 0, 1])
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    start = {"position": cycloid.position(1.0), "velocity": 5.0 * cycloid.frenet(1.0)[0]}
    scene.constrain(rb.PointOnCurve(cycloid), scene.add(rb.Particle(1.0), **start), name="arc")
    with pytest.raises(rb.IntegrationError, match="the curve of arc at u = 3.14.*cusp") as caught:
        rb.simulate(scene, until=3.0)
    # along the arc it swings like a spring: s'' = -g s/(4 R), s = 4 R sin(u/2), up to s = 4 R
    size, rate = 4 * 0.3, np.sqrt(GRAVITY / (4 * 0.3))
    reach, phase = np.hypot(size * np.sin(0.5), 5.0 / rate), np.arctan2(5.0 / rate, size * np.sin(0.5))
    assert caught.value.run.end == pytest.approx((phase - np.arccos(size / reach)) / rate, abs=1e-10)


def test_a_cusp_of_a_rail_on_a_body_ends_the_run_by_name():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    table = scene.add(rb.shapes.box(2.0, [1, 1, 1]), rb.Prismatic([1, 0, 0]))
    scene.add(rb.Particle(1.0), rb.Rail(rb.Cycloid(0.3, [1, 0, 0], [0, 0, 1])), parent=table, parameter=1.0, speed=5.0)
    with pytest.raises(rb.IntegrationError, match="rail of bead .* u = 3.14.*cusp"):
        rb.simulate(scene, until=3.0)


def test_a_rail_on_a_body_ends_too():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    table = scene.add(rb.shapes.box(2.0, [1, 1, 1]), rb.Prismatic([1, 0, 0]))
    chute = rb.Rail(rb.Polynomial([[0, 0, 0], [0, 0, -1]], domain=(0.0, 2.0)))
    bead = scene.add(rb.Particle(1.0), chute, parent=table, parameter=0.5)
    run = rb.simulate(scene, until=5.0, error=1e-11)
    assert [e.kind for e in run.events] == ["rail-end"] and run.events[0].subject == bead
    assert run.end == pytest.approx(np.sqrt(3.0 / GRAVITY), abs=1e-11)


def test_a_start_off_the_curve_is_refused_or_assembled():
    scene = rb.Scene(gravity=[0, -GRAVITY, 0])
    body = scene.add(
        rb.RigidBody(1.0, [0.1, 0.1, 0.1], com=[0, -0.5, 0]), rb.Planar([1, 0, 0], [0, 1, 0]), position=[0.5, 0.3]
    )
    on = scene.constrain(rb.PointOnCurve(rb.Parabola(1.0, [1, 0, 0], [0, 1, 0])), body.point([0, 0, 0]), name="track")
    with pytest.raises(rb.InvalidInput, match="track: gap is 0.03"):
        rb.simulate(scene, until=1.0)
    scene.assemble()
    run = rb.simulate(scene, until=1.0)
    x, y, _ = run[body].position(0.0)
    assert y == pytest.approx(x**2, abs=1e-14) and abs(x - 0.5) < 0.05
    assert run[on].gap(0.0) < 1e-15


def test_velocities_across_the_curve_are_refused():
    scene = rb.Scene()
    bead = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[1, 1, 0])
    scene.constrain(rb.PointOnCurve(rb.Circle(1.0, [1, 0, 0], [0, 1, 0])), bead, name="hoop")
    with pytest.raises(rb.InvalidInput, match="hoop: rate of its gap is 1"):
        rb.simulate(scene, until=1.0)


def test_rows_that_a_slide_has_already_are_redundant():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    slider = scene.add(rb.shapes.box(2.0, [1, 1, 1]), rb.Prismatic([3, 0, -4]))
    on = scene.constrain(rb.PointOnCurve(rb.Line([3, 0, -4], point=[0.5, 0, 0.5])), slider.point([0.5, 0, 0.5]))
    plan = rb.plan(scene)
    assert plan.freedom == 1
    run = rb.simulate(scene, until=1.0, error=1e-11)
    assert run[slider].displacement(1.0) == pytest.approx(0.5 * 0.8 * GRAVITY, abs=1e-11)
    assert run[on].force(0.5) == pytest.approx([0, 0, 0], abs=1e-12)


def test_a_bead_passes_the_crossing_of_a_figure_of_eight_on_its_branch():
    eight = rb.Curve(lambda u: [np.sin(u), np.sin(u) * np.cos(u), 0 * u], domain=(0, 2 * np.pi), closed=True)
    speed = 1.0
    for direction in ([1, 1, 0], [1, -1, 0]):
        scene = rb.Scene()
        unit = np.array(direction) / np.sqrt(2)
        bead = scene.add(rb.Particle(1.0), velocity=speed * unit)
        scene.constrain(rb.PointOnCurve(eight), bead)
        length = eight.length(0, 2 * np.pi)
        run = rb.simulate(scene, until=length, error=1e-10)
        assert run[bead].position(length / 2) == pytest.approx([0, 0, 0], abs=1e-9)
        assert run[bead].velocity(length / 2) == pytest.approx(-unit * [1, -1, 0], abs=1e-9)
        assert run[bead].velocity(length) == pytest.approx(unit, abs=1e-9)


def test_small_oscillations_on_a_parabola():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    bead = scene.add(rb.Particle(1.0), position=[0.3, 0, 0.09])
    scene.constrain(rb.PointOnCurve(rb.Parabola(1.0, [1, 0, 0], [0, 0, 1])), bead)
    (rest,) = rb.equilibria(scene)
    assert rest.stable and rest.coordinates == pytest.approx([0, 0, 0], abs=1e-9)
    assert rb.normal_modes(scene, at=rest).squares == pytest.approx([2.0 * GRAVITY], rel=1e-10)


def test_it_goes_to_files_and_back(tmp_path):
    scene, bar, across, up = trammel(1.0, position=[0.6, 0.8, 0], attitude=rb.EulerAngles(0, -np.arctan2(0.8, 0.6), 0))
    rb.save(scene, tmp_path / "trammel.json")
    again = rb.load(tmp_path / "trammel.json")
    assert again == scene and pickle.loads(pickle.dumps(scene)) == scene
    one, other = (rb.simulate(s, until=1.0, rtol=1e-10) for s in (scene, again))
    assert np.array_equal(one[bar].position(1.0), other[again[bar.name]].position(1.0))
    whole = rb.simulate(scene, until=1.0, error=1e-10)
    rb.save(rb.simulate(scene, until=0.5, error=1e-10), tmp_path / "half.npz")
    rest = rb.simulate(rb.load(tmp_path / "half.npz"), until=1.0)
    assert rest[bar].position(1.0) == pytest.approx(whole[bar].position(1.0), abs=1e-10)
    assert rb.PointOnCurve(rb.Line([1, 0, 0])) == rb.PointOnCurve(rb.Line([1, 0, 0]))
    assert isinstance(rb.PointOnCurve(rb.Circle(1.0, [1, 0, 0], [0, 1, 0])).curve, rb.Circle)


def test_an_action_moves_what_is_held_along_its_curve():
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    hoop = rb.Circle(0.5, [0, 0, -1], [1, 0, 0])
    bead = scene.add(rb.Particle(1.0), position=[0.5, 0, 0])
    scene.constrain(rb.PointOnCurve(hoop), bead)
    scene.watch(
        "moved",
        lambda now: now.time - 0.25,
        action=lambda now: {bead: {"position": [-0.5, 0, 0], "velocity": [0, 0, 0]}},
    )
    run = rb.simulate(scene, until=0.5, error=1e-11)
    assert run[bead].position(0.5) == pytest.approx(run[bead].position(0.25, side="before") * [-1, 1, 1], abs=1e-11)
