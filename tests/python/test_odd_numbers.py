"""Every number a scene or a run takes, given as nan and as infinity: refused by name, never simulated."""

import math

import numpy as np
import pytest
import rbdyn as rb

Z = [0.0, 0.0, 1.0]
BODY = rb.RigidBody(1.0, [1.0, 1.0, 1.0])


def moved(scene):
    rb.simulate(scene, 0.1, rtol=1e-6)


def particle(**start):
    scene = rb.Scene()
    return scene, scene.add(rb.Particle(1.0), **start)


def of_body(joint, **start):
    scene = rb.Scene()
    scene.add(BODY, joint, **start)
    moved(scene)


def bead(curve, **options):
    scene = rb.Scene(gravity=[0, 0, -1.0])
    rail = {k: options.pop(k) for k in list(options) if k in ("drive", "up", "friction", "motion")}
    scene.add(rb.Particle(1.0), rb.Rail(curve, **rail), **options)
    moved(scene)


def loaded(load, joint=None, **at):
    scene = rb.Scene()
    handle = scene.add(BODY, joint) if joint else scene.add(BODY, angular_velocity=[0.1, 0.2, 0.3])
    scene.apply(load, handle, **at)
    moved(scene)


def coupled(coupling, **ends):
    scene = rb.Scene()
    a = scene.add(rb.Particle(1.0), position=[1.0, 0, 0])
    b = scene.add(rb.Particle(1.0), position=[3.0, 0, 0])
    scene.connect(coupling, a, ends.get("end", b))
    moved(scene)


def held(constraint, **start):
    scene = rb.Scene()
    body = scene.add(BODY, position=[1.0, 0, 0])
    scene.constrain(constraint, body.point(start.get("point", [0, 0, 0])), start.get("end"))
    moved(scene)


def touched(part, surface, **options):
    scene = rb.Scene()
    body = scene.add(BODY, position=[0, 0, 3.0])
    other = scene.add(BODY, position=[0, 9.0, 0])
    scene.contact(part(body), surface(other), **options)
    moved(scene)


def run_with(**options):
    scene, _ = particle(velocity=[1.0, 0, 0])
    rb.simulate(scene, **options)


def asked(ask):
    scene, p = particle(velocity=[1.0, 0, 0])
    ask(rb.simulate(scene, 1.0), p)


CIRCLE = {"radius": 1.0, "start": [1.0, 0, 0], "toward": [0, 1.0, 0], "center": [0.5, 0, 0]}
HINGE = {"axis": Z, "at": [0.5, 0, 0], "point": [0.5, 0, 0]}
BY_SHAPE = {
    "rod": {"mass": 1.0, "length": 1.0, "along": Z},
    "box": {"mass": 1.0, "size": [1.0, 1.0, 1.0]},
    "disc": {"mass": 1.0, "radius": 1.0, "normal": Z},
    "ring": {"mass": 1.0, "radius": 1.0, "normal": Z},
    "cylinder": {"mass": 1.0, "radius": 1.0, "height": 1.0, "axis": Z},
    "sphere": {"mass": 1.0, "radius": 1.0},
    "shell": {"mass": 1.0, "radius": 1.0},
    "cone": {"mass": 1.0, "radius": 1.0, "height": 1.0, "axis": Z},
    "ellipsoid": {"mass": 1.0, "semi_axes": [1.0, 1.0, 1.0]},
}

# what takes numbers, with numbers it takes
TAKES = {
    "Scene": (lambda **k: rb.Scene(**k), {"gravity": [0, 0, -1.0]}),
    "Particle": (lambda **k: rb.Particle(**k), {"mass": 1.0}),
    "RigidBody": (lambda **k: rb.RigidBody(**k), {"mass": 1.0, "inertia": [1.0, 1.0, 1.0], "com": [0.5, 0, 0]}),
    "particle": (lambda **k: moved(particle(**k)[0]), {"position": [1.0, 0, 0], "velocity": [1.0, 0, 0]}),
    "body": (
        lambda **k: of_body(rb.Free(), **k),
        {"position": [1.0, 0, 0], "velocity": [1.0, 0, 0], "angular_velocity": [1.0, 0, 0], "attitude": [1.0, 0, 0, 0]},
    ),
    "body in the world": (lambda **k: of_body(rb.Free(), **k), {"angular_velocity_world": [1.0, 0, 0]}),
    "EulerAngles": (
        lambda **k: of_body(rb.Free(), attitude=rb.EulerAngles(**k)),
        {"theta": 1.0, "psi": 1.0, "phi": 1.0},
    ),
    "Spherical": (lambda **k: of_body(rb.Spherical(**k)), {"at": [1.0, 0, 0], "point": [0.5, 0, 0]}),
    "Revolute": (lambda **k: of_body(rb.Revolute(**k)), HINGE),
    "Prismatic": (lambda **k: of_body(rb.Prismatic(**k)), HINGE),
    "Cylindrical": (lambda **k: of_body(rb.Cylindrical(**k)), HINGE),
    "Universal": (
        lambda **k: of_body(rb.Universal(**k)),
        {"first": Z, "second": [1.0, 0, 0], "at": [0.5, 0, 0], "point": [0.5, 0, 0]},
    ),
    "Planar": (lambda **k: of_body(rb.Planar(**k)), {"x": [1.0, 0, 0], "y": [0, 1.0, 0], "at": [0.5, 0, 0]}),
    "Fixed": (
        lambda **k: of_body(rb.Fixed(**k)),
        {"at": [0.5, 0, 0], "point": [0.5, 0, 0], "attitude": [1.0, 0, 0, 0]},
    ),
    "on a Revolute": (lambda **k: of_body(rb.Revolute(Z), **k), {"angle": 1.0, "rate": 1.0}),
    "on a Prismatic": (lambda **k: of_body(rb.Prismatic(Z), **k), {"displacement": 1.0, "rate": 1.0}),
    "on a Cylindrical": (
        lambda **k: of_body(rb.Cylindrical(Z), **k),
        {"angle": 1.0, "rate": 1.0, "displacement": 1.0, "displacement_rate": 1.0},
    ),
    "on a Universal": (
        lambda **k: of_body(rb.Universal(Z, [1, 0, 0]), **k),
        {"angles": [1.0, 1.0], "rates": [1.0, 1.0]},
    ),
    "in a Planar": (
        lambda **k: of_body(rb.Planar([1, 0, 0], [0, 1, 0]), **k),
        {"position": [1.0, 1.0], "velocity": [1.0, 1.0], "angle": 1.0, "rate": 1.0},
    ),
    "driven hinge of time": (lambda value: of_body(rb.Revolute(Z, motion=lambda t: value * t)), {"value": 1.0}),
    "driven slide of time": (lambda value: of_body(rb.Prismatic(Z, motion=lambda t: value + t)), {"value": 1.0}),
    "Line": (lambda **k: bead(rb.Line(**k)), {"direction": [1.0, 0, 0], "point": [0.5, 0, 0]}),
    "Circle": (lambda **k: bead(rb.Circle(**k)), CIRCLE),
    "Parabola": (
        lambda **k: bead(rb.Parabola(**k)),
        {"a": 1.0, "x": [1.0, 0, 0], "y": [0, 0, 1.0], "vertex": [0.5, 0, 0]},
    ),
    "Cycloid": (
        lambda **k: bead(rb.Cycloid(**k)),
        {"radius": 1.0, "x": [1.0, 0, 0], "y": [0, 0, 1.0], "vertex": [0.5, 0, 0]},
    ),
    "Helix": (lambda **k: bead(rb.Helix(**k)), {**CIRCLE, "pitch": 1.0}),
    "Polynomial": (lambda value: bead(rb.Polynomial([[0, 0, 0], [value, 0, 0], [0, 0, 1.0]])), {"value": 1.0}),
    "Spline": (lambda value: bead(rb.Spline([[0, 0, 0], [value, 0, 0], [2, 0, 1.0], [3, 0, 0]])), {"value": 1.0}),
    "Curve": (lambda value: bead(rb.Curve(lambda u: [value * u, 0, u**2], domain=(-9, 9))), {"value": 1.0}),
    "on a rail": (lambda **k: bead(rb.Line([1, 0, 0]), **k), {"parameter": 1.0, "speed": 1.0}),
    "along a rail": (lambda **k: bead(rb.Line([1, 0, 0]), **k), {"arc_length": 1.0}),
    "drive": (lambda **k: bead(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.5), **k), {"drive": 1.0}),
    "Coulomb": (lambda **k: bead(rb.Line([1, 0, 0]), friction=rb.Coulomb(**k)), {"mu_static": 1.0, "mu_dynamic": 0.5}),
    "Force": (lambda value: loaded(rb.Force(value)), {"value": [1.0, 0, 0]}),
    "Force at": (lambda **k: loaded(rb.Force([1, 0, 0]), **k), {"at": [1.0, 0, 0]}),
    "Torque": (lambda value: loaded(rb.Torque(value)), {"value": [1.0, 0, 0]}),
    "Drag": (lambda **k: loaded(rb.Drag(**k)), {"linear": 1.0, "quadratic": 1.0}),
    "Lorentz": (lambda **k: loaded(rb.Lorentz(**k)), {"strength": 1.0, "field": [1.0, 0, 0]}),
    "TorsionSpring": (
        lambda **k: loaded(rb.TorsionSpring(**k), rb.Revolute(Z)),
        {"stiffness": 1.0, "rest_angle": 1.0, "damping": 1.0},
    ),
    "JointTorque": (lambda value: loaded(rb.JointTorque(value), rb.Revolute(Z)), {"value": 1.0}),
    "JointForce": (lambda value: loaded(rb.JointForce(value), rb.Prismatic(Z)), {"value": 1.0}),
    "JointTorque of a parameter": (
        lambda value: loaded(rb.JointTorque(rb.parameter(value, "m")), rb.Revolute(Z)),
        {"value": 1.0},
    ),
    "Spring": (lambda **k: coupled(rb.Spring(**k)), {"stiffness": 1.0, "rest_length": 1.0, "damping": 1.0}),
    "Spring to": (lambda **k: coupled(rb.Spring(1.0), **k), {"end": [0, 0, 1.0]}),
    "Gravitation": (lambda **k: coupled(rb.Gravitation(**k)), {"constant": 1.0}),
    "Rod": (lambda **k: held(rb.Rod(**k), end=[0.0, 0, 0]), {"length": 1.0}),
    "Hinge": (lambda **k: held(rb.Hinge(**k)), {"axis": Z}),
    "shaft": (lambda **k: held(rb.Universal(**k)), {"first": Z, "second": [1.0, 0, 0]}),
    "Plane": (lambda **k: held(rb.PointOnPlane(rb.Plane(**k))), {"normal": [1.0, 0, 0], "point": [1.0, 0, 0]}),
    "Ball of a point": (lambda **k: held(rb.Ball(), **k), {"point": [0, 0, 1.0]}),
    "Ball to the world": (lambda **k: held(rb.Ball(), **k), {"end": [1.0, 0, 0]}),
    "sphere": (
        lambda **k: touched(lambda b: b.sphere(**k), lambda _: rb.Plane(Z)),
        {"radius": 1.0, "center": [0, 0, 0.5]},
    ),
    "disc": (
        lambda **k: touched(lambda b: b.disc(**k), lambda _: rb.Plane(Z)),
        {"radius": 1.0, "normal": [0, 0.5, 1.0], "center": [0, 0, 0.5]},
    ),
    "ellipsoid": (
        lambda **k: touched(lambda b: b.ellipsoid(**k), lambda _: rb.Plane(Z)),
        {"semi_axes": [1.0, 1.0, 1.0], "center": [0, 0, 0.5], "attitude": [1.0, 0, 0, 0]},
    ),
    "point that touches": (
        lambda value: touched(lambda b: b.point(value), lambda _: rb.Plane(Z)),
        {"value": [0, 0, 0.5]},
    ),
    "Plane that is touched": (
        lambda **k: touched(lambda b: b, lambda _: rb.Plane(**k)),
        {"normal": Z, "point": [0, 0, 0.5]},
    ),
    "Sphere that is touched": (
        lambda **k: touched(lambda b: b, lambda _: rb.Sphere(**k)),
        {"center": [0, 0, 0.5], "radius": 1.0},
    ),
    "plane of a body": (
        lambda **k: touched(lambda b: b, lambda o: o.plane(**k)),
        {"normal": Z, "point": [0, 0, 0.5]},
    ),
    "contact": (lambda **k: touched(lambda b: b, lambda _: rb.Plane(Z), **k), {"restitution": 0.5}),
    "simulate": (lambda **k: run_with(**k), {"until": 1.0, "start": 0.5, "error": 1e-6}),
    "simulate locally": (lambda **k: run_with(until=1.0, **k), {"rtol": 1e-6}),
    "simulate and keep": (lambda value: run_with(until=1.0, keep=[0.25, value]), {"value": 0.5}),
    "position": (lambda value: asked(lambda r, p: r[p].position(value)), {"value": 0.5}),
    "energy": (lambda value: asked(lambda r, _: r.energy(value)), {"value": 0.5}),
    "work": (lambda begin, end: asked(lambda r, _: r.work(begin, end)), {"begin": 0.25, "end": 0.5}),
    "sample": (lambda value: asked(lambda r, _: r.sample([0.25, value])), {"value": 0.5}),
    "angular momentum": (lambda **k: asked(lambda r, _: r.angular_momentum(0.5, **k)), {"pole": [0, 0, 1.0]}),
    "shifted": (lambda value: BODY.shifted(value), {"value": [1.0, 0, 0]}),
    "rotated": (lambda value: BODY.rotated(value), {"value": [1.0, 0, 0, 0]}),
    "points": (lambda value: rb.shapes.points([1.0, 1.0], [[0, 0, 0], value]), {"value": [1.0, 0, 0]}),
    "masses": (lambda value: rb.shapes.points([1.0, value], [[0, 0, 0], [1, 0, 0]]), {"value": 1.0}),
    **{
        f"shapes.{name}": (lambda name=name, **k: getattr(rb.shapes, name)(**k), numbers)
        for name, numbers in BY_SHAPE.items()
    },
}
# friction that never slips
MAY_BE_INFINITE = {("Coulomb", "mu_static", math.inf)}


def odd(value, number):
    """A number, or each component of a vector in turn, made odd."""
    if not isinstance(value, list):
        return [number]
    return [value[:i] + [number] + value[i + 1 :] for i in range(len(value))]


@pytest.mark.parametrize("what", TAKES)
def test_it_takes_numbers(what):
    make, numbers = TAKES[what]
    make(**numbers)


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf], ids=str)
@pytest.mark.parametrize("what", TAKES)
def test_numbers_that_are_none_are_refused(what, number):
    make, numbers = TAKES[what]
    for name, value in numbers.items():
        if (what, name, number) in MAY_BE_INFINITE:
            continue
        for wrong in odd(value, number):
            with pytest.raises(ValueError) as caught:
                make(**{**numbers, name: wrong})
            # a sentence with the number in it
            message = str(caught.value)
            assert isinstance(caught.value, rb.InvalidInput) and (":" in message), (name, message)


def test_a_force_that_becomes_no_number_is_named_with_its_time():
    scene, p = particle(position=[1.0, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [rb.where(t > 0.5, np.nan, 1.0) * r[0], 0, 0]), p)
    with pytest.raises(rb.IntegrationError, match=r"not finite at t = 0\.5.* force .* on particle 1") as caught:
        rb.simulate(scene, 1.0)
    assert caught.value.run.end == pytest.approx(0.5, abs=1e-6)


def test_a_joint_torque_that_becomes_no_number_ends_where_it_does():
    scene = rb.Scene()
    hinge = scene.add(BODY, rb.Revolute(Z))
    scene.apply(rb.JointTorque(lambda t, angle, rate: np.sqrt(0.3 - t)), hinge)
    with pytest.raises(rb.IntegrationError, match=r"the joint load .* on body 1") as caught:
        rb.simulate(scene, 1.0)
    assert caught.value.run.end == pytest.approx(0.3, abs=1e-6)


def test_a_body_is_no_surface():
    scene = rb.Scene()
    a, b = scene.add(BODY), scene.add(BODY, position=[3.0, 0, 0])
    with pytest.raises(rb.InvalidInput, match="body 2 or a point of it, which has no surface"):
        scene.contact(a, b)


@pytest.mark.parametrize("engine", ["taylor", "dop853", "cvode-adams", "cvode-bdf"])
@pytest.mark.parametrize("start", [1.0, 1e6, 1e9])
@pytest.mark.parametrize("spacings", [1, 2, 3, 5])
def test_a_span_of_a_few_spacings_of_time_is_a_motion(engine, start, spacings):
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(2.0), velocity=[0, 1, 0])
    end = start
    for _ in range(spacings):
        end = math.nextafter(end, math.inf)
    span = end - start
    for accuracy in ({"error": 1e-9}, {"rtol": 1e-8}):
        run = rb.simulate(scene, end, start=start, engine=engine, **accuracy)
        expected = [0, span, -0.5 * 9.81 * span**2]
        assert run[ball].position(end) == pytest.approx(expected, rel=1e-8, abs=1e-7 * span)


def test_times_too_far_from_zero_to_be_told_apart_are_named():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(2.0), velocity=[0, 1, 0])
    scene.apply(rb.Drag(quadratic=0.2), ball)
    with pytest.raises(rb.IntegrationError, match=r"times there are 16 s apart.*nearer to t = 0"):
        rb.simulate(scene, 1e17 + 320, start=1e17)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("accuracy", [{"rtol": 1e-9}, {"error": 1e-9}])
def test_a_linear_force_with_a_number_that_is_none_is_named(bad, accuracy):
    scene = rb.Scene()
    ball = scene.add(rb.Particle(2.0), position=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [bad * r[0], 0, 0]), ball)
    with pytest.raises(rb.IntegrationError, match='not finite at t = 0 s: force "<lambda>"'):
        rb.simulate(scene, 2.0, **accuracy)


@pytest.mark.parametrize("accuracy", [{"rtol": 1e-9}, {"error": 1e-9}])
def test_a_closed_form_that_outgrows_the_numbers_ends_there(accuracy):
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [r[0], 0, 0]), ball)
    with pytest.raises(rb.IntegrationError, match="the motion grows beyond the largest number") as caught:
        rb.simulate(scene, 2000.0, **accuracy)
    run = caught.value.run
    assert run.status == "not finite"
    # exp(t) is of that size
    assert run.end == pytest.approx(1024 * math.log(2), abs=1.0)
    assert run[ball].position(700.0)[0] == pytest.approx(0.5 * math.exp(700.0), rel=1e-9)
    assert np.isfinite(run[ball].position(run.end)).all()


CURVES = {
    "line": rb.Line([1, 0, 0]),
    "circle": rb.Circle(1.0, [1, 0, 0], [0, 1, 0]),
    "helix": rb.Helix(1.0, 0.2, [1, 0, 0], [0, 1, 0]),
    "parabola": rb.Parabola(1.0, [1, 0, 0], [0, 1, 0]),
    "cycloid": rb.Cycloid(1.0, [1, 0, 0], [0, 1, 0]),
    "spline": rb.Spline([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 1]]),
    "polynomial": rb.Polynomial([[0, 0, 0], [1, 0, 0], [0, 0, 1]]),
    "function": rb.Curve(lambda u: [u, np.sin(u), 0.2 * u**2]),
}


@pytest.mark.parametrize("asked", ["position", "frenet", "curvature", "torsion"])
@pytest.mark.parametrize("name", CURVES)
def test_a_curve_has_no_place_at_a_parameter_that_is_none(name, asked):
    """Nor one that doubles do not hold: no answer has a number in it that is none."""
    ask = getattr(CURVES[name], asked)
    for bad in (math.nan, math.inf, -math.inf):
        for given in (bad, [0.5, bad]):
            with pytest.raises(rb.InvalidInput, match=r"parameter is -?(nan|inf); it"):
                ask(given)
    for far in (1e308, -1e308, 5e-324):
        try:
            told = ask(far)
        except rb.InvalidInput as refused:
            assert f"{far:g}" in str(refused) and "; " in str(refused)
        else:
            assert np.isfinite(told).all()


TURNED = rb.EulerAngles(0.3, 0.1, 0.2)
LEANING = rb.EulerTop(rb.RigidBody(1.0, [0.5, 0.5, 0.25], com=[0, 0, 0.5], inertia_about="origin"), gravity=9.81)
TURNING = rb.PoinsotMotion(rb.RigidBody(1.0, [1, 2, 2.5]), [0.1, 1, 0.2])


def hill():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    return rb.rail_potential(scene, scene.add(rb.Particle(1.0), rb.Rail(CURVES["circle"])))


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda x: TURNED.rates([0, x, 0]), "EulerAngles: component 1 of angular_velocity is"),
        (lambda x: TURNED.angular_velocity([0, 0, x]), "EulerAngles: component 2 of rates is"),
        (lambda x: TURNED.angular_acceleration([0, 0, 0], [x, 0, 0]), "EulerAngles: component 0 of second is"),
        (lambda x: TURNED.right_side([0, 0, 0], [1, 1, x], [0, 0, 0]), "EulerAngles: component 2 of moments is"),
        (lambda x: TURNED.right_side([0, 0, 0], [1, 1, 1], [0, x, 0]), "EulerAngles: component 1 of torque is"),
        (lambda x: rb.EulerAngles(0.1, x, 0.2).rates([0, 0, 1]), "EulerAngles: psi is"),
        (lambda x: rb.EulerAngles(x, 0.1, 0.2).matrix, "EulerAngles: theta is"),
        (lambda x: LEANING.state(TURNED, [0, x, 0]), "EulerTop: component 1 of angular_velocity is"),
        (lambda x: LEANING.state(rb.EulerAngles(1, 1, x), [0, 1, 0]), "EulerTop: variable 2 of the state is"),
        (lambda x: LEANING.rates([1, 1, x, 0, 0, 0]), "EulerTop: variable 2 of the state is"),
        (lambda x: BODY.inertia([0, x, 0]), r"RigidBody: point\[1\] is"),
        (lambda x: BODY.principal([0, 0, x]), r"RigidBody: point\[2\] is"),
        (lambda x: TURNING.polhode(3, x), "PoinsotMotion: until is"),
        (lambda x: TURNING.herpolhode(3, x), "PoinsotMotion: until is"),
        (lambda x: hill().energy(0.0, x), "speed is"),
        (lambda x: hill().energy(x, 0.0), "parameter is"),
        (lambda x: hill().value([0.0, x]), "parameter is"),
        (lambda x: rb.Rail(rb.Line([1, 0, 0]), drive=lambda t: 2.0 * t).drive(x), "Rail: time is"),
    ],
)
def test_what_derives_from_numbers_that_are_none_is_refused(call, words, bad):
    with pytest.raises(rb.InvalidInput, match=words) as refused:
        call(bad)
    assert str(bad) in str(refused.value) and "; " in str(refused.value)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: TURNING.herpolhode(3, until=1e300), "until is 1e\\+300; beyond"),
        (lambda: TURNING.polhode(3, until=-1e308), "until is -1e\\+308; beyond"),
        (lambda: rb.simulate(rb.Scene(), 8e307, start=-8e307), "until is 8e\\+307; it is at most 2\\^1020 s"),
        (lambda: BODY.inertia([0, 1e308, -1e308]), "of the inertia about a point is .*beyond what a double holds"),
        (lambda: LEANING.rates(np.zeros(6)), "sin theta is 0 is nan; Euler angles fail where"),
        (lambda: LEANING.state(rb.EulerAngles(0, 0, 0), [1, 1, 0]), "have no bound where sin theta is 0"),
        (lambda: TURNED.angular_velocity([1e308] * 3), "the angular velocity is .*beyond what a double holds"),
        (lambda: TURNED.right_side([1e200] * 3, [1, 2, 2.5], [0] * 3), "the right side is .*beyond what a double"),
        (lambda: TURNED.right_side([0] * 3, [1, 0, 1], [0] * 3), r"moments\[1\] is 0; a principal moment is positive"),
        (lambda: hill().energy(0.0, [1.0, 1e200]), "energy at parameter 0 and speed 1e\\+200 is inf; it is beyond"),
    ],
)
def test_results_that_a_double_does_not_hold_are_refused(call, words):
    with pytest.raises(rb.InvalidInput, match=words):
        call()


def test_where_a_body_is_on_its_polhode_is_told_as_long_as_digits_last():
    """Of omega's way at 1e16 s all digits are right: the state after a whole number of periods is that of the start."""
    period = TURNING.period
    far = TURNING.polhode(2, 2.0**40 * period)[1]
    # a period has 53 digits, and 2^40 of them as many: 2^-13 periods are unknown
    assert np.abs(far - TURNING.polhode(2, period)[1]).max() < 2.0**-12 * 2 * np.pi
    assert np.isfinite(TURNING.polhode(3, until=1e16)).all()
