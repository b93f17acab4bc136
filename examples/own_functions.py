"""Every kind of function of one's own: a curve, forces, a potential, a drive, a moving rail, watches, an integral.

Each is plain NumPy, recorded once; then no Python runs during the integration. What cannot be recorded is called back.
"""

import importlib
import math
from typing import Any

import numpy as np
import rbdyn as rb

GRAVITY = [0, 0, -9.81]


def curve() -> None:
    """Any smooth curve r(u); arc length is not needed."""
    scene = rb.Scene(gravity=GRAVITY)
    track = rb.Rail(rb.Curve(lambda u: [u, np.sin(u), 0.2 * u**2], domain=(-4, 4)))
    bead = scene.add(rb.Particle(mass=0.2), track, parameter=1.0)
    run = rb.simulate(scene, until=5.0, error=1e-10)
    # released at rest and smooth: the height says how fast
    height = run[bead].position(3.0)[2]
    assert math.isclose(run[bead].speed(3.0) ** 2, 2 * 9.81 * (0.2 - height), rel_tol=1e-8)
    assert run.statistics.python_calls == 0


def force() -> None:
    """f(t, position, velocity): both sides of an `if` are recorded, and where it changes is an event."""
    scene = rb.Scene(gravity=GRAVITY)
    ball = scene.add(rb.Particle(mass=0.5), position=[0, 0, 1.0])

    def cushion(t: Any, position: Any, velocity: Any) -> Any:
        depth = -position[2]
        push = 400.0 * depth if depth > 0 else 0.0
        return np.array([0.0, 0.0, push])

    def wind(t: Any, position: Any, velocity: Any) -> Any:
        return np.where(position[2] > 0.5, [0.2, 0.0, 0.0], 0.0)

    scene.apply(rb.Force(cushion), ball)
    scene.apply(rb.Force(wind), ball)
    run = rb.simulate(scene, until=1.0, error=1e-10)
    # free fall to half the height, out of the wind, then to the cushion, into it and out again
    fall = np.sqrt([2 * 0.5 / 9.81, 2 * 1.0 / 9.81])
    np.testing.assert_allclose(run.events.times("switch")[:2], fall, rtol=1e-10)
    print(*rb.plan(scene).functions, sep="\n")


def potential() -> None:
    """U(position) in joules; the force is +grad U, derived exactly, and U is part of the energy."""
    scene = rb.Scene()
    planet = scene.add(rb.Particle(mass=1.0), position=[1, 0, 0], velocity=[0, 1.2, 0])
    scene.apply(rb.Potential(lambda position: 1.0 / np.linalg.norm(position)), planet)
    run = rb.simulate(scene, until=30.0, error=1e-10)
    assert run.drift["energy"] < 1e-12


def drive() -> None:
    """The surface of a rail slides with a speed that is a function of time."""
    scene = rb.Scene(gravity=GRAVITY)
    belt = rb.Rail(rb.Line([1, 0, 0]), friction=rb.Coulomb(0.5), drive=lambda t: 2.0 * t**2)
    block = scene.add(rb.Particle(mass=1.0), belt)
    run = rb.simulate(scene, until=2.0, error=1e-10)
    # it slips when the belt's acceleration 4 t reaches 0.5 g
    (slip,) = run.events.times("slip", block)
    assert math.isclose(slip, 0.5 * 9.81 / 4, rel_tol=1e-10)


def moving_rail() -> None:
    """A rail that moves as a rigid body: here a straight tube that turns about the vertical."""
    rate = 1.5

    def turn(t: Any) -> Any:
        c, s = np.cos(rate * t), np.sin(rate * t)
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    scene = rb.Scene(gravity=GRAVITY)
    bead = scene.add(rb.Particle(mass=0.1), rb.Rail(rb.Line([1, 0, 0]), motion=turn), parameter=0.2)
    run = rb.simulate(scene, until=2.0, error=1e-10)
    assert math.isclose(run[bead].parameter(2.0), 0.2 * math.cosh(rate * 2.0), rel_tol=1e-8)


def watched() -> None:
    """A function of the motion: its zeros are events that are recorded, stop the run, or change the state."""
    scene = rb.Scene(gravity=GRAVITY)
    ball = scene.add(rb.Particle(mass=0.5), velocity=[1.0, 0, 5.0])
    apex = scene.watch("apex", lambda now: now[ball].velocity[2], direction="falling")

    def bounce(now: rb.Now) -> dict[rb.BodyHandle, dict[str, list[float]]]:
        vx, vy, vz = now[ball].velocity
        return {ball: {"velocity": [vx, vy, -0.8 * vz]}}

    scene.watch("floor", lambda now: now[ball].position[2], direction="falling", action=bounce)
    scene.watch("wall", lambda now: now[ball].position[0] - 2.0, action="stop")
    run = rb.simulate(scene, until=10.0, error=1e-10)
    assert run.status == "stopped by event" and math.isclose(run.end, 2.0, rel_tol=1e-10)
    up = 5.0 / 9.81
    np.testing.assert_allclose(run.events.times("apex"), [up, 2 * up + 0.8 * up], rtol=1e-10)
    assert abs(run[apex].value(up)) < 1e-9  # m/s
    print(*run.events, sep="\n")


def integral() -> None:
    """A first integral of one's own: its drift is reported with those of the library."""
    scene = rb.Scene()
    planet = scene.add(rb.Particle(mass=1.0), position=[1, 0, 0], velocity=[0, 1.2, 0])
    scene.apply(rb.Potential(lambda position: 1.0 / np.linalg.norm(position)), planet)

    def eccentricity(now: rb.Now) -> Any:
        r, v = now[planet].position, now[planet].velocity
        return np.linalg.norm(np.cross(v, np.cross(r, v)) - r / np.linalg.norm(r))

    scene.integral("eccentricity", eccentricity)
    run = rb.simulate(scene, until=30.0, error=1e-10)
    assert run.drift["eccentricity"] < 1e-9


def parameter() -> None:
    """A number used by reference: a sweep records nothing anew."""
    resistance = rb.parameter(0.0, "resistance")
    calls: list[Any] = []

    def drag(t: Any, position: Any, velocity: Any) -> Any:
        calls.append(t)
        return -resistance * np.linalg.norm(velocity) * velocity

    scene = rb.Scene()
    ball = scene.add(rb.Particle(mass=1.0), velocity=[2.0, 0, 0])
    scene.apply(rb.Force(drag), ball)
    for value in (0.1, 0.2, 0.4):
        resistance.value = value
        run = rb.simulate(scene, until=3.0, error=1e-10)
        assert math.isclose(run[ball].velocity(3.0)[0], 2.0 / (1 + value * 2.0 * 3.0), rel_tol=1e-8)
    assert len(calls) == 1


def called_back() -> None:
    """What cannot be recorded is called back: slower, but it works, and the plan says which line is why."""
    scene = rb.Scene()
    ball = scene.add(rb.Particle(mass=1.0))
    scene.apply(rb.Force(lambda t, position, velocity: [math.sin(t), 0.0, 0.0]), ball)
    run = rb.simulate(scene, until=2.0, error=1e-10)
    assert math.isclose(run[ball].velocity(2.0)[0], 1 - math.cos(2.0), rel_tol=1e-9)
    assert run.statistics.python_calls > 0
    print(*rb.plan(scene).functions, sep="\n")


def compiled() -> None:
    """What numba has compiled is called by its address, without Python; a SciPy LowLevelCallable likewise."""
    try:
        numba: Any = importlib.import_module("numba")
    except ImportError:
        print("compiled functions: skipped, numba is not installed")
        return
    doubles = numba.types.CPointer(numba.float64)

    def drag(t: Any, position: Any, velocity: Any, force: Any) -> None:
        speed = math.sqrt(velocity[0] ** 2 + velocity[1] ** 2 + velocity[2] ** 2)
        for i in range(3):
            force[i] = -0.1 * speed * velocity[i]

    native: Any = numba.cfunc(numba.void(numba.float64, doubles, doubles, doubles))(drag)
    loads = [rb.Force(native)]
    try:
        scipy: Any = importlib.import_module("scipy")
        loads.append(rb.Force(scipy.LowLevelCallable(native.ctypes)))
    except ImportError:
        print("LowLevelCallable: skipped, SciPy is not installed")
    for load in loads:
        scene = rb.Scene()
        ball = scene.add(rb.Particle(mass=1.0), velocity=[2.0, 0, 0])
        scene.apply(load, ball)
        run = rb.simulate(scene, until=3.0, error=1e-10)
        assert math.isclose(run[ball].velocity(3.0)[0], 2.0 / (1 + 0.1 * 2.0 * 3.0), rel_tol=1e-8)
        assert run.statistics.python_calls == 0
        print(*rb.plan(scene).functions, sep="\n")


for example in (curve, force, potential, drive, moving_rail, watched, integral, parameter, called_back, compiled):
    example()
