"""Members of a sweep side by side through vectors: what that gains, and heyoka's batch beside it where it is installed.

Microseconds of thread time a member of the whole call on one thread, least of nine, one after the other and side by
side, in turns; and how many times as quick the second is. Members of each row start differently.

N: the heavy body of bodies.py for 5 s, all members alike so that the error at the end is known; of the tolerances by
half powers of ten the quickest that reaches an error counts. heyoka: taylor_adaptive_batch of 4 and of 8, the
integration alone, without compilation.
"""

import math
import time
from functools import partial

import numpy as np
import rbdyn as rb
from bodies import END_OF_N, ERRORS, SCENES, difference, scene_of, slopes, start_of

COUNT = 64
DOWN = [0, 0, -9.8125]


def spins():
    scene, body = scene_of("N")
    return scene, {(body, "angular_velocity"): np.outer(np.linspace(250, 350, COUNT), [0, 0, 1])}, 5.0


def thrown():
    scene = rb.Scene(gravity=DOWN)
    ball = scene.add(rb.Particle(1.0), position=[0, 0, 1], velocity=[1, 0, 4])
    scene.apply(rb.Drag(linear=0.1, quadratic=0.02), ball)
    return scene, {(ball, "velocity"): np.outer(np.linspace(1, 9, COUNT), [1, 0, 1])}, 5.0


def beads():
    scene = rb.Scene(gravity=DOWN)
    one, other = (
        scene.add(rb.Particle(1.0), rb.Rail(rb.Circle(1.0, [0, y, -1], [1, 0, 0])), parameter=u)
        for y, u in ((0.0, 0.3), (1.0, -0.3))
    )
    scene.connect(rb.Spring(stiffness=5.0, rest_length=0.5), one, other)
    return scene, {(one, "speed"): np.linspace(3, 5, COUNT)}, 10.0


def rods(count):
    bar = rb.RigidBody(1.0, [0.5, 0.5, 0.25], com=[0, 0, -0.5])

    def made():
        scene = rb.Scene(gravity=DOWN)
        first = last = scene.add(bar, rb.Revolute([0, 1, 0]))
        for _ in range(count - 1):
            last = scene.add(bar, rb.Revolute([0, 1, 0], at=[0, 0, -1]), parent=last)
        return scene, {(first, "angle"): np.linspace(0.1, 1, COUNT), (last, "rate"): np.linspace(0, 1, COUNT)}, 2.0

    return made


def hoop():
    scene = rb.Scene(gravity=DOWN)
    rail = rb.Rail(rb.Circle(1.0, [0, 0, -1], [1, 0, 0]), friction=rb.Coulomb(0.15, 0.1))
    bead = scene.add(rb.Particle(1.0), rail, parameter=2.0)
    return scene, {(bead, "speed"): np.linspace(3, 9, COUNT)}, 10.0


def table():
    scene = rb.Scene(gravity=DOWN)
    ball = scene.add(rb.shapes.sphere(1.0, 0.1), position=[0, 0, 0.1])
    scene.contact(ball.sphere(0.1), rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.25), restitution=0.5)
    return scene, {(ball, "velocity"): np.outer(np.linspace(1, 3, COUNT), [1, 0.2, 1])}, 2.0


ROWS = {
    "heavy body N, spins": spins,
    "particle with drag": thrown,
    "two beads and a spring": beads,
    "double pendulum": rods(2),
    "five hinged rods": rods(5),
    "rough hoop": hoop,
    "ball that bounces and slides": table,
}


def microseconds(ways, count, repeats=9):
    """Of one member by each of some functions, in turns, least of several."""
    least = [math.inf] * len(ways)
    for _ in range(repeats):
        for i, way in enumerate(ways):
            began = time.thread_time()
            way()
            least[i] = min(least[i], time.thread_time() - began)
    return [1e6 * seconds / count for seconds in least]


def rows():
    for options in ({"rtol": 1e-10, "keep": "end"}, {"error": 1e-9}):
        print(f"microseconds a member, {COUNT} members, {options}")
        print(f"  {'':30}{'one by one':>12}{'side by side':>14}{'quicker':>9}")
        for name, make in ROWS.items():
            scene, vary, until = make()

            def run(lanes, scene=scene, vary=vary, until=until, options=options):
                return rb.simulate_many(scene, vary, until, threads=1, lanes=lanes, **options)

            apart, beside = microseconds([partial(run, False), partial(run, True)], COUNT)
            print(f"  {name:30}{apart:12.1f}{beside:14.1f}{apart / beside:9.2f}", flush=True)


def batches(exact):
    """What each peer's batch takes and misses by tolerance: (microseconds, error) by name."""
    scene, body = scene_of("N")
    omega, until = SCENES["N"][2], SCENES["N"][4]
    alike = {(body, "angular_velocity"): np.tile(omega, (COUNT, 1))}

    def library(lanes):
        def go(tolerance):
            many = []

            def run():
                many[:] = [
                    rb.simulate_many(
                        scene, alike, until, rtol=tolerance, keep="end", engine="taylor", threads=1, lanes=lanes
                    )
                ]

            (least,) = microseconds([run], COUNT, 5)
            end = [*many[0][5][body].angular_velocity(until), *many[0][5][body].quaternion(until)]
            return least, difference(end, exact)

        return go

    yield "rbdyn, one by one", library(False)
    yield "rbdyn, side by side", library(True)
    try:
        import heyoka
    except ImportError:
        return
    names = heyoka.make_vars(*(f"x{i}" for i in range(7)))
    system = list(zip(names, slopes("N", list(names)), strict=True))
    for width in (4, 8):

        def go(tolerance, width=width):
            start = np.repeat(np.array(start_of("N"))[:, None], width, 1)
            batch = heyoka.taylor_adaptive_batch(system, start, tol=tolerance)

            def run():
                batch.set_time(0.0)
                batch.state[:] = start
                batch.propagate_until([until] * width)

            (least,) = microseconds([run], width)
            return least, difference(batch.state[:, 0], exact)

        yield f"heyoka, batch of {width}", go


def members_of_n():
    """Microseconds a member by name, for each of ERRORS; nan: not reached."""
    least = {}
    for name, go in batches([float(x) for x in END_OF_N.split()]):
        found = [go(10.0 ** (-k / 2)) for k in range(14, 32)]
        least[name] = [min((us for us, miss in found if miss <= error), default=math.nan) for error in ERRORS]
    return least


def main():
    rows()
    print("N, microseconds a member at true errors of " + ", ".join(f"{error:.0e}" for error in ERRORS))
    for name, least in members_of_n().items():
        print(f"  {name:30}" + "".join(f"{us:10.0f}" for us in least), flush=True)


if __name__ == "__main__":
    main()
