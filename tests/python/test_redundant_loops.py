"""Constraints of which some rows depend on others, on what turns: held against trees with the joints they amount to."""

import numpy as np
import pytest
import rbdyn as rb

DOWN = [0, 0, -9.8125]
TIMES = np.linspace(0, 4, 9)
ORIGIN = np.array([0.5, 0.2, 0.1])  # of the lid, on the body that tumbles
CARRIER = rb.RigidBody(1.0, [0.3, 0.4, 0.5], com=[0.2, 0.1, -0.3])
LID = rb.RigidBody(2.0, [0.5, 0.4, 0.6], com=[0.2, 0.1, 0])
ENGINES = ({"error": 1e-9}, {"error": 1e-7, "engine": "dop853"}, {"error": 1e-6, "engine": "cvode-adams"})


def crossed(r):
    return np.cross(np.eye(3), np.asarray(r))  # r x, as a matrix


def tumbling(kind, seed, joined):
    """A body on a ball joint and one on it: by constraints, or by the joint they amount to."""
    rng = np.random.default_rng(seed)
    scene = rb.Scene(gravity=DOWN)
    omega = rng.uniform(-3, 3, 3)
    carrier = scene.add(CARRIER, rb.Spherical(), angular_velocity=omega)
    x, y, z = rng.uniform(-1, 1, (3, 3))
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    rate = 1.0 if kind in ("two balls", "balls in a line") else 0.0
    if joined:
        joint = rb.Revolute(axis, at=ORIGIN) if rate else rb.Fixed(at=ORIGIN)
        return scene, carrier, scene.add(LID, joint, parent=carrier, **({"rate": rate} if rate else {})), []
    if kind.endswith(" and a ball"):
        joint = {"hinge": rb.Revolute, "slide": rb.Prismatic, "cylinder": rb.Cylindrical}[kind.split()[0]]
        lid = scene.add(LID, joint(axis, at=ORIGIN), parent=carrier)
    else:
        velocity = np.cross(omega, ORIGIN)
        lid = scene.add(LID, position=ORIGIN, velocity=velocity, angular_velocity=omega + rate * axis)
    points = {
        "two balls": (0 * x, 0.7 * axis),
        "balls in a line": (0 * x, 0.7 * axis, -0.4 * axis),
        "three balls": (x, y, z),
    }.get(kind, (x,))
    held = []
    if kind == "crossed hinges":
        for point, along in ((x, axis), (y, np.cross(axis, [1, 0, 0]))):
            held.append((point, scene.constrain(rb.Hinge(along), lid.point(point), carrier.point(point + ORIGIN))))
    else:
        for k, point in enumerate(points):
            ends = lid.point(point), carrier.point(point + ORIGIN)
            # which of both is named first says nothing
            held.append((point, scene.constrain(rb.Ball(), *(ends if k % 2 == 0 else ends[::-1]))))
    return scene, carrier, lid, held


KINDS = (
    "two balls",
    "balls in a line",
    "three balls",
    "hinge and a ball",
    "slide and a ball",
    "cylinder and a ball",
    "crossed hinges",
)


@pytest.mark.parametrize("kind", KINDS)
def test_a_lid_on_a_tumbling_body_moves_as_on_the_joint_it_amounts_to(kind):
    for seed in range(4):
        scene, carrier, lid, _ = tumbling(kind, seed, True)
        joined = rb.simulate(scene, until=4.0, error=1e-11)
        turns, places = joined[carrier].rotation_matrix(TIMES), joined[lid].position(TIMES)
        scene, carrier, lid, held = tumbling(kind, seed, False)
        for how in ENGINES if seed == 0 else ENGINES[:1]:
            run = rb.simulate(scene, until=4.0, **how)
            off = max(
                abs(run[carrier].rotation_matrix(TIMES) - turns).max(), abs(run[lid].position(TIMES) - places).max()
            )
            assert off <= 10 * how["error"], (kind, seed, how)
            assert len(run.events) == 0
            # each shares its force with another one, or with the joint
            assert run.plan.not_unique == [handle.name for _, handle in held]
            assert run.plan.freedom == (4 if kind in KINDS[:2] else 3)


@pytest.mark.parametrize("kind", KINDS[:3])
def test_forces_of_ball_joints_that_share_a_load_are_those_of_least_norm(kind):
    for seed in range(3):
        scene, _, lid, _ = tumbling(kind, seed, True)
        joined = rb.simulate(scene, until=4.0, error=1e-11)
        scene, _, other, held = tumbling(kind, seed, False)
        run = rb.simulate(scene, until=4.0, error=1e-9)
        for t in TIMES[1:]:
            # what the joint exerts on the lid, about its point, from forces at the balls
            load = np.concatenate([joined[lid].reaction(t), joined[lid].reaction_torque(t)])
            axes = run[other].rotation_matrix(t)
            acts = np.hstack([np.vstack([np.eye(3), crossed(axes @ point)]) for point, _ in held])
            least = np.linalg.pinv(acts, rcond=1e-9) @ load
            for k, (_, handle) in enumerate(held):
                force = run[handle].force(t) * (1 if k % 2 == 0 else -1)
                assert np.allclose(force, least[3 * k : 3 * k + 3], rtol=0, atol=1e-7)


def test_a_gusset_on_a_pendulum():
    # a plane hinge and a ball: a weld, of which the ball bears the moment about the hinge
    body = rb.RigidBody(1.0, [0.1, 0.2, 0.25], com=[0.5, 0, 0])
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    runs = []
    for welded in (True, False):
        scene = rb.Scene(gravity=[0, -9.8125, 0])
        upper = scene.add(body, rb.Revolute([0, 0, 1]), rate=3.0)
        if welded:
            lower = scene.add(body, rb.Fixed(attitude=turn, at=[1, 0, 0]), parent=upper)
        else:
            lower = scene.add(body, rb.Revolute([0, 0, 1], at=[1, 0, 0]), parent=upper, angle=np.arctan2(0.6, 0.8))
            arm = np.array([0.3, -0.7, 0.0])
            ball = scene.constrain(rb.Ball(), lower.point(arm), upper.point(turn @ arm + [1, 0, 0]))
        runs.append((rb.simulate(scene, until=4.0, error=1e-10), lower))
    (weld, one), (gusset, other) = runs
    assert abs(weld[one].position(TIMES) - gusset[other].position(TIMES)).max() < 1e-10
    for t in TIMES[1:]:
        lever = gusset[other].rotation_matrix(t) @ arm
        force = gusset[ball].force(t)
        moment = weld[one].reaction_torque(t)[2]
        assert abs(np.cross(lever, force)[2] - moment) < 1e-8
        assert abs(lever @ force) < 1e-8 and force[2] == 0.0


def bennett(law):
    """Bennett's linkage, four hinges in space of which the last one closes the loop: K of its angles."""
    twist, other = np.radians([40.0, 75.0])
    lengths = [1.0, np.sin(other) / np.sin(twist), 1.0]
    twists = [twist, other, twist]
    ratio = np.sin((other + twist) / 2) / np.sin((other - twist) / 2)
    first = 0.9
    second = 2 * np.arctan(ratio / np.tan(first / 2))
    angles = [first, second, -first]
    scene = rb.Scene(gravity=DOWN)
    # axes of all bodies lie as the world's at coordinates zero
    axes = np.eye(3)
    body, bodies, now = None, [], np.eye(3)
    reached = np.zeros(3)
    at = np.zeros(3)
    for length, bend, angle in zip(lengths, twists, angles, strict=True):
        axis = axes @ [0, 0, 1]
        along = axes @ [length, 0, 0]
        more = {} if body is None else {"parent": body}
        rate = 1.0 if body is None else 0.0
        body = scene.add(
            rb.RigidBody(1.0, [0.2, 0.25, 0.3], com=along / 2), rb.Revolute(axis, at=at), angle=angle, rate=rate, **more
        )
        bodies.append(body)
        about = crossed(axis)
        now = now @ (np.eye(3) + np.sin(angle) * about + (1 - np.cos(angle)) * about @ about)
        reached = reached + now @ along
        at = along
        c, s = np.cos(bend), np.sin(bend)
        axes = axes @ [[1, 0, 0], [0, c, -s], [0, s, c]]
    last = axes @ [0, 0, 1]
    if law == "hinge":
        scene.constrain(rb.Hinge(now @ last), body.point(at), reached)
    else:
        for shift in (0.0, 0.5):
            scene.constrain(rb.Ball(), body.point(at + shift * last), reached + shift * (now @ last))
    scene.assemble(keep=[bodies[0]])
    return scene, bodies, ratio


@pytest.mark.parametrize("law", ["hinge", "balls"])
def test_bennetts_linkage_goes_round(law):
    # what depends on what changes with the angles: no choice of rows is good all the way
    scene, bodies, ratio = bennett(law)
    run = rb.simulate(scene, until=8.0, error=1e-9)
    assert run.plan.freedom == 1 and len(run.events) == 0
    t = np.linspace(0, 8, 81)
    first, second, third = (run[body].angle(t) for body in bodies)
    # G. T. Bennett, Engineering 76, 1903: tan(a/2) tan(b/2) is the same all the way, opposite angles are opposite
    assert np.ptp(first) > 1.0
    product = np.sin(first / 2) * np.sin(second / 2) - ratio * np.cos(first / 2) * np.cos(second / 2)
    assert abs(product).max() < 1e-9
    assert abs(np.sin((first + third) / 2)).max() < 1e-9
    assert abs(run.energy(t) / run.energy(0.0) - 1).max() < 1e-9


@pytest.mark.parametrize("law", ["hinge", "balls"])
@pytest.mark.parametrize(("engine", "rtol"), [("dop853", 1e-9), ("dop853", 1e-7), ("cvode-adams", 1e-8)])
def test_engines_that_hold_no_constraints_are_moved_onto_them_where_other_rows_are_used(law, engine, rtol):
    # what they leave open multiplied at each change of rows: a thousand times as much, or "constraint 2 opens"
    scene, bodies, ratio = bennett(law)
    run = rb.simulate(scene, until=8.0, rtol=rtol, engine=engine)
    t = np.linspace(0, 8, 81)
    first, second, third = (run[body].angle(t) for body in bodies)
    product = np.sin(first / 2) * np.sin(second / 2) - ratio * np.cos(first / 2) * np.cos(second / 2)
    # errors of steps add up over some turns
    assert abs(product).max() < 1e3 * rtol
    assert abs(np.sin((first + third) / 2)).max() < 1e3 * rtol
    assert len(run.events) == 0


def test_a_linkage_on_a_tumbling_base_passes_nothing_singular():
    # axes through one point, closed by a ball: of its rows one depends on the others, along what turns with the base
    def unit(v):
        return np.array(v) / np.linalg.norm(v)

    scene = rb.Scene(gravity=DOWN)
    base = scene.add(rb.RigidBody(3.0, [1, 1.2, 1.5]), rb.Spherical(), angular_velocity=[0.5, 1.0, 0.3])
    axes = [unit([1, 0, 0.2]), unit([0.8, 0.9, 0.3]), unit([0.1, 1.0, 0.6]), unit([-0.3, 0.4, 1.0])]
    parts, parent = [], base
    for one, two in zip(axes, axes[1:], strict=False):
        body = rb.RigidBody(1.0, [0.3, 0.4, 0.5], com=(one + two) / 2)
        parent = scene.add(body, rb.Revolute(one), parent=parent, rate=0.0 if parts else 2.0)
        parts.append(parent)
    pin = scene.constrain(rb.Ball(), parent.point(axes[3]), base.point(axes[3]))
    scene.assemble(keep=[base, parts[0]])
    run = rb.simulate(scene, until=4.0, error=1e-9)
    assert run.plan.freedom == 4 and run.plan.not_unique == [pin.name] and len(run.events) == 0
    assert run[pin].gap(np.linspace(0, 4, 41)).max() < 1e-9
    assert run.drift["energy"] < 1e-8


def test_a_third_crank_is_redundant():
    # three cranks and the bar that couples them move as one pendulum, also where a row of the third one is none
    cranks, count = [], 3
    scene = rb.Scene(gravity=[0, -9.8125, 0])

    def bar(mass, length):
        moment = mass * length**2 / 12
        return rb.RigidBody(mass, [0.01, moment, moment], com=[length / 2, 0, 0])

    for k in range(count):
        cranks.append(scene.add(bar(1.0, 1.0), rb.Revolute([0, 0, 1], at=[1.5 * k, 0, 0]), angle=-0.4, rate=-0.5))
    rod = scene.add(bar(2.0, 3.0), rb.Revolute([0, 0, 1], at=[1, 0, 0]), parent=cranks[0], angle=0.4, rate=0.5)
    for k in range(1, count):
        scene.constrain(rb.Ball(), rod.point([1.5 * k, 0, 0]), cranks[k].point([1, 0, 0]))
    run = rb.simulate(scene, until=1.0, error=1e-9)
    inertia, moment = count / 3 + 2.0, count / 2 + 2.0
    alone = rb.Scene(gravity=[0, -9.8125, 0])
    mass = 5.0
    own = inertia - moment**2 / mass
    pendulum = alone.add(
        rb.RigidBody(mass, [0.1, own, own], com=[moment / mass, 0, 0]), rb.Revolute([0, 0, 1]), angle=-0.4, rate=-0.5
    )
    truth = rb.simulate(alone, until=1.0, error=1e-11)
    t = np.linspace(0, 1, 11)
    assert abs(run[cranks[2]].angle(t) - truth[pendulum].angle(t)).max() < 1e-9
    assert run[cranks[2]].angle(1.0) < -np.pi / 2 and len(run.events) == 0
    assert run.plan.freedom == 1


def test_rest_and_modes_of_redundant_loops_are_those_of_the_joints():
    for kind in ("two balls", "three balls", "slide and a ball", "crossed hinges"):
        found = []
        for joined in (True, False):
            scene, carrier, lid, _ = tumbling(kind, 1, joined)
            scene.connect(rb.Spring(40.0, rest_length=0.5), carrier.point([0.3, 0.3, 0.3]), [1, 1, 0])
            scene.connect(rb.Spring(10.0, rest_length=0.5), lid.point([0.3, 0.3, 0.3]), [1, -1, 0])
            (rest,) = rb.equilibria(scene)
            assert rest.stable
            found.append(rb.normal_modes(scene, at=rest).squares)
        assert np.allclose(found[0], found[1], rtol=1e-9, atol=0)


@pytest.mark.parametrize("com", [[0, 0, 0], [0.2, 0.1, -0.15]])
def test_a_weld_without_points_keeps_bodies_where_they_start(com):
    com, omega = np.array(com), np.array([1.0, 2.0, 0.5])
    attitude = np.array([0.8, 0.36, -0.48, 0.0])
    w, v = attitude[0], attitude[1:]
    turn = (w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * crossed(v)
    body = rb.RigidBody(1.5, [0.2, 0.3, 0.4], com=com)
    runs = []
    for welded in (True, False):
        scene = rb.Scene(gravity=DOWN)
        carrier = scene.add(CARRIER, rb.Spherical(), angular_velocity=omega)
        if welded:
            moves = {"velocity": np.cross(omega, ORIGIN), "angular_velocity": turn.T @ omega}
            lid = scene.add(body, position=ORIGIN, attitude=attitude, **moves)
            weld = scene.constrain(rb.Weld(), lid, carrier)
        else:
            lid = scene.add(body, rb.Fixed(attitude=attitude, at=ORIGIN + turn @ com, point=com), parent=carrier)
        runs.append((rb.simulate(scene, until=4.0, error=1e-10), carrier, lid))
    (held, one, other), (fixed, third, fourth) = runs
    assert held.plan.freedom == 3 and held.plan.not_unique == []
    assert abs(held[one].rotation_matrix(TIMES) - fixed[third].rotation_matrix(TIMES)).max() < 1e-9
    assert abs(held[other].position(TIMES) - fixed[fourth].position(TIMES)).max() < 1e-9
    # at a's point, its centre of mass
    for t in TIMES[1:]:
        assert np.allclose(held[weld].force(t), fixed[fourth].reaction(t), rtol=0, atol=1e-7)
        assert np.allclose(held[weld].torque(t), fixed[fourth].reaction_torque(t), rtol=0, atol=1e-7)


def test_a_weld_of_points_still_holds_them_together():
    scene = rb.Scene()
    one = scene.add(CARRIER)
    other = scene.add(LID, position=[1, 0, 0])
    scene.constrain(rb.Weld(), other.point([0, 0, 0]), one.point([0, 0, 0]), name="weld")
    with pytest.raises(rb.InvalidInput, match="weld: gap is 1"):
        rb.simulate(scene, until=1.0)
