"""Numbers of the user's wherever a number is taken: by reference, or refused with a sentence."""

import math
import pickle

import numpy as np
import pytest
import rbdyn as rb

ERROR = 1e-10


def falling(load, body=None):
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    ball = scene.add(rb.Particle(0.5), position=[1, 0, 0], velocity=[0, 1, 0])
    scene.apply(load, ball)
    return scene


def sprung(spring):
    scene = rb.Scene()
    ball = scene.add(rb.Particle(2.0), position=[1.5, 0, 0], velocity=[0, 1, 0])
    scene.connect(spring, ball, [0, 0, 0])
    return scene


def between(spring):
    scene = rb.Scene()
    a = scene.add(rb.Particle(2.0), position=[1.5, 0, 0], velocity=[0, 1, 0])
    b = scene.add(rb.Particle(1.0))
    scene.connect(spring, a, b)
    return scene


def hinged(load):
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    bar = scene.add(rb.RigidBody(1.0, [0.5, 0.5, 0.5], com=[0, 0, -0.5]), rb.Revolute([0, 1, 0]), angle=0.5)
    scene.apply(load, bar)
    return scene


def free(load):
    scene = rb.Scene()
    body = scene.add(rb.RigidBody(1.0, [1.0, 2.0, 2.5]), velocity=[1, 0, 0], angular_velocity=[0.1, 1.0, 0.2])
    scene.apply(load, body)
    return scene


def on_belt(**options):
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    friction = options.pop("friction", rb.Coulomb(0.5, 0.25))
    block = scene.add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0]), friction=friction, **options), speed=1.0)
    scene.connect(rb.Spring(stiffness=16.0), block, [0, 0, 0])
    return scene


def thrown(mass):
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    ball = scene.add(rb.Particle(mass), position=[1, 0, 0], velocity=[3, 1, 0])
    scene.apply(rb.Drag(quadratic=0.25), ball)
    return scene


# a scene for a number, and values it may have
PLACES = {
    "stiffness": (lambda k: sprung(rb.Spring(stiffness=k, rest_length=0.5)), (3.0, 5.0, 0.0, 2.0)),
    "stiffness of a linear spring": (lambda k: sprung(rb.Spring(k)), (3.0, 5.0, 0.0, 2.0)),
    "rest length": (lambda k: sprung(rb.Spring(4.0, rest_length=k)), (0.5, 0.25, 0.0, 1.0)),
    "damping": (lambda k: sprung(rb.Spring(4.0, damping=k)), (0.5, 0.25, 0.0, 1.0)),
    "stiffness between two": (lambda k: between(rb.Spring(k, 0.25)), (3.0, 5.0, 0.0, 2.0)),
    "linear drag": (lambda k: falling(rb.Drag(k)), (0.5, 0.25, 0.0, 1.0)),
    "quadratic drag": (lambda k: falling(rb.Drag(0.1, quadratic=k)), (0.5, 0.25, 0.0, 1.0)),
    "drag of a body": (lambda k: free(rb.Drag(k, k)), (0.5, 0.25, 0.0, 1.0)),
    "force": (lambda k: falling(rb.Force([k, 0, 0.5])), (0.5, 0.25, 0.0, -1.0)),
    "force of an array": (lambda k: falling(rb.Force(np.array([0, k, k]))), (0.5, 0.25, 0.0, -1.0)),
    "force in body axes": (lambda k: free(rb.Force((k, 0, 1.0), frame="body")), (0.5, 0.25, 0.0, -1.0)),
    "torque": (lambda k: free(rb.Torque([0, 0, k])), (0.5, 0.25, 0.0, -1.0)),
    "charge": (lambda k: falling(rb.Lorentz(k, [0, 1, 2])), (0.5, 0.25, 0.0, -1.0)),
    "torsion spring": (lambda k: hinged(rb.TorsionSpring(k)), (3.0, 5.0, 0.0, 2.0)),
    "torsion spring, rest": (lambda k: hinged(rb.TorsionSpring(2.0, rest_angle=k)), (0.5, 0.25, 0.0, -1.0)),
    "torsion spring, damping": (lambda k: hinged(rb.TorsionSpring(2.0, damping=k)), (0.5, 0.25, 0.0, 1.0)),
    "drive": (lambda k: on_belt(drive=k), (0.5, 0.25, 0.0, -1.0)),
    "mass": (lambda k: thrown(k), (0.5, 0.25, 2.0, 1.0)),
    "static friction": (lambda k: on_belt(friction=rb.Coulomb(k, 0.25), drive=0.25), (0.5, 0.25, 0.75, 1.0)),
    "dynamic friction": (lambda k: on_belt(friction=rb.Coulomb(0.5, k), drive=0.25), (0.5, 0.25, 0.0, 0.125)),
    "friction": (lambda k: on_belt(friction=rb.Coulomb(k)), (0.5, 0.25, 0.0, 0.125)),
}


def motion(run):
    times = np.linspace(0.0, 1.0, 9)
    states = [run[body].position(times) for body in run.bodies] + [run[body].acceleration(times) for body in run.bodies]
    states += [run[body].rotation_matrix(times)[:, 0] for body in run.bodies if "quaternion" in run[body].quantities]
    return np.array(states), [e.time for e in run.events], run.energy(times)


@pytest.mark.parametrize("place", PLACES)
def test_a_parameter_is_taken_by_reference_where_a_number_is(place):
    scene_of, values = PLACES[place]
    k = rb.parameter(values[0], "k")
    scene = scene_of(k)
    runs = []
    for k.value in (*values, values[0]):
        plain = rb.simulate(scene_of(k.value), 1.0, error=ERROR)
        run = rb.simulate(scene, 1.0, error=ERROR)
        for here, there in zip(motion(run), motion(plain), strict=True):
            np.testing.assert_allclose(here, there, rtol=0, atol=1e3 * ERROR)
        assert rb.plan(scene).effects == rb.plan(scene_of(k.value)).effects
        runs.append((run, motion(run)))
    # the number matters, and a run keeps the one it was started with
    assert not np.allclose(runs[0][1][0], runs[1][1][0], rtol=0, atol=1e-4)
    for run, before in runs:
        for here, there in zip(motion(run), before, strict=True):
            np.testing.assert_array_equal(here, there)


SWEPT = [place for place in PLACES if place not in ("mass", "static friction", "dynamic friction", "friction")]


@pytest.mark.parametrize("place", SWEPT)
def test_loads_couplings_and_drives_keep_their_plan_over_a_sweep(place):
    scene_of, _ = PLACES[place]
    k = rb.parameter(0.375, "k")
    scene = scene_of(k)
    planned = []
    # (0.5 is where the hinge starts: there the torque of its spring begins with zero)
    for k.value in (0.375, 0.625, 0.75):
        planned.append(rb.simulate(scene, 1.0, rtol=1e-9).statistics.planned)
    assert planned == [True, False, False]


@pytest.mark.parametrize("place", PLACES)
def test_a_scene_with_a_parameter_in_it_is_data(place):
    scene_of, values = PLACES[place]
    k = rb.parameter(values[0], "k")
    scene = scene_of(k)
    assert scene == scene_of(k)
    copy, own = pickle.loads(pickle.dumps((scene, k)))
    assert copy == scene and own.name == "k"
    own.value = values[1]
    there = motion(rb.simulate(scene_of(values[1]), 1.0, error=ERROR))
    for here, other in zip(motion(rb.simulate(copy, 1.0, error=ERROR)), there, strict=True):
        np.testing.assert_allclose(here, other, rtol=0, atol=1e3 * ERROR)


def test_what_holds_a_parameter_says_so():
    k = rb.parameter(2.0, "k")
    spring = rb.Spring(k, damping=0.5)
    assert spring.stiffness is k and spring.damping == 0.5
    assert repr(spring) == "Spring(stiffness=parameter(2, 'k'), rest_length=0, damping=0.5)"
    assert hash(spring) == hash(rb.Spring(k, damping=0.5))
    assert spring == pickle.loads(pickle.dumps(spring)) != rb.Spring(2.0, damping=0.5)
    assert "parameter" in repr(rb.Force([k, 0, 0]))


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        ("stiffness", -1.0, "Spring: stiffness is -1"),
        ("linear drag", -1.0, "Drag: linear is -1"),
        ("mass", 0.0, "Particle: mass is 0"),
        ("dynamic friction", 0.75, "Coulomb: mu_dynamic is 0.75"),
        ("torsion spring", -1.0, "TorsionSpring: stiffness is -1"),
    ],
)
def test_a_value_that_breaks_a_rule_is_refused_when_a_run_starts(place, value, message):
    scene_of, values = PLACES[place]
    k = rb.parameter(values[0], "k")
    scene = scene_of(k)
    k.value = value
    with pytest.raises(rb.InvalidInput, match=message):
        rb.simulate(scene, 1.0)


k = rb.parameter(2.0, "k")
body = rb.RigidBody(1.0, [1, 1, 1])


def run_of():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[1, 0, 0])
    return scene, ball, rb.simulate(scene, 3.0)


@pytest.mark.parametrize(
    ("use", "where"),
    [
        (lambda: rb.Scene(gravity=[0, 0, k]), "gravity"),
        (lambda: rb.RigidBody(k, [1, 1, 1]), r"rb\.RigidBody\(k"),
        (lambda: rb.RigidBody(1.0, [k, k, k]), "inertia"),
        (lambda: rb.RigidBody(1.0, [1, 1, 1], com=[0, 0, k]), "com"),
        (lambda: rb.shapes.sphere(k, 1.0), r"sphere\(k"),
        (lambda: rb.shapes.box(1.0, [1, k, 1]), "size"),
        (lambda: rb.shapes.points([1.0, k], [[0, 0, 0], [1, 0, 0]]), "masses"),
        (lambda: rb.shapes.solid(k, [(0, 1), (0, 1), (0, 1)]), "density"),
        (lambda: rb.shapes.solid(lambda x, y, z: 1.0 + k * x, [(0, 1), (0, 1), (0, 1)]), "write .value"),
        (lambda: rb.shapes.solid(1.0, [(0, 1), (0, k), (0, 1)]), "bounds of y"),
        (lambda: body.shifted([k, 0, 0]), "r is"),
        (lambda: rb.Circle(k, [0, 0, -1], [1, 0, 0]), r"rb\.Circle\(k"),
        (lambda: rb.Circle(1.0, [0, 0, -1], [k, 0, 0]), "toward"),
        (lambda: rb.Helix(1.0, k, [0, 0, -1], [1, 0, 0]), r"rb\.Helix"),
        (lambda: rb.Line([1, 0, k]), "direction"),
        (lambda: rb.Parabola(k, [1, 0, 0], [0, 0, 1]), r"rb\.Parabola"),
        (lambda: rb.Cycloid(k, [1, 0, 0], [0, 0, 1]), r"rb\.Cycloid"),
        (lambda: rb.Polynomial([[0, 0, k], [1, 0, 0]]), "coefficients"),
        (lambda: rb.Spline([[0, 0, k], [1, 0, 0], [2, 0, 0]]), "points"),
        (lambda: rb.Curve(lambda u: [u, k * u**2, 0.0], domain=(0, 1)), "parameter k, and a curve is measured once"),
        (lambda: rb.Curve(lambda u: [u, u**2, 0.0], domain=(0, k)), r"rb\.Curve"),
        (lambda: rb.Line([1, 0, 0]).position(k), "parameter is"),
        (lambda: rb.Lorentz(1.0, [0, 0, k]), "field"),
        (lambda: rb.Spherical(at=[0, 0, k]), "at"),
        (lambda: rb.Revolute([0, 0, k]), "axis"),
        (lambda: rb.Prismatic([0, 0, 1], point=[k, 0, 0]), "point"),
        (lambda: rb.EulerAngles(k, 0.0, 0.0), r"rb\.EulerAngles\(k"),
        (lambda: rb.Scene().add(rb.Particle(1.0), position=[k, 0, 0]), "position"),
        (lambda: rb.Scene().add(rb.Particle(1.0), rb.Rail(rb.Line([1, 0, 0])), speed=k), "speed"),
        (lambda: rb.Scene().add(body, attitude=[1, 0, 0, k]), "attitude"),
        (lambda: rb.Scene().add(body, rb.Revolute([0, 0, 1]), angle=k), "angle"),
        (lambda of=run_of: (lambda s: s[0].connect(rb.Spring(1.0), s[1], [0, 0, k]))(of()), "b is"),
        (lambda: rb.simulate(run_of()[0], k), r"simulate\("),
        (lambda: rb.simulate(run_of()[0], 1.0, error=k), r"simulate\("),
        (lambda: rb.simulate(run_of()[0], 1.0, start=k), r"simulate\("),
        (lambda: rb.simulate(run_of()[0], 1.0, keep=[0.5, k]), "keep"),
        (lambda: rb.cost(run_of()[0], 1.0, budget=k), r"cost\("),
        (lambda: run_of()[2].sample([0.0, k]), "times|time"),
        (lambda: run_of()[2].energy(k), "time"),
        (lambda: rb.PoinsotMotion(body, [k, 0, 0]), "angular_velocity"),
        (lambda: rb.parameter(k), "value"),
        (lambda: rb.Function(lambda x: 2 * x)(k), "an input"),
        (lambda: bool(k), "k: .*value"),
        (lambda: math.floor(k), "k: .*value"),
        (lambda: round(k), "k: .*value"),
    ],
)
def test_elsewhere_a_parameter_is_refused_with_a_sentence_that_names_place_and_fix(use, where):
    with pytest.raises(rb.InvalidInput, match=where) as refused:
        use()
    assert "value" in str(refused.value)


def test_a_function_that_asks_whether_a_parameter_is_zero_is_not_recorded_as_if_it_were_not():
    p = rb.parameter(0.0, "p")
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0))
    scene.apply(rb.Force(lambda t, r, v: [1.0 if p else 0.0, 1.0 if p == 3.0 else 0.0, 0]), ball)
    for p.value, expected in ((0.0, [0, 0, 0]), (2.0, [0.5, 0, 0]), (3.0, [0.5, 0.5, 0])):
        np.testing.assert_allclose(rb.simulate(scene, 1.0)[ball].position(1.0), expected, rtol=0, atol=1e-8)
