"""The problems that other libraries are given too."""

import math

import rbdyn as rb

from . import DOWN, ball, belt, heavy_body, ladder, symmetric_top, two_beads
from .euler_equations import euler_slopes
from .linkages import andrews, four_bar, triple_pendulum
from .problem import G, Mode, Problem

# --- rigid bodies: angular velocity and quaternion ---


def body_slopes(moments, center):
    lever = center and [0.5 * G * r for r in center]
    return lambda state, _: euler_slopes(moments, lever, state)


def signed(numbers):
    """A quaternion and its opposite are one attitude."""
    sign = math.copysign(1.0, numbers[3])
    return [*numbers[:3], *(sign * x for x in numbers[3:])]


def body(about, moments, center, omega, tilt, until, scene):
    def read(run):
        handle = run.bodies[0]
        return signed([*run[handle].angular_velocity(run.end), *run[handle].quaternion(run.end)])

    return Problem(
        about,
        [*omega, math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0],
        until,
        {"only": Mode(body_slopes(moments, center))},
        scene,
        read,
        groups=(slice(0, 3), slice(3, 7)),
        told=lambda state, _: signed(state),
    )


def free_body():
    scene = rb.Scene()
    scene.add(rb.RigidBody(1.0, [1.0, 2.0, 3.0]), angular_velocity=[0.01, 1.0, 0.02])
    return scene, 100.0


SPIN, CENTER = (0.0, 0.0, 300.0), (0.01, 0.005, 0.05)
MOMENTS = (0.0022, 0.0019, 0.001)


# --- points ---


def places(run, coordinates):
    """Positions and velocities of all bodies, of these coordinates."""
    at = [run[b].position(run.end)[k] for b in run.bodies for k in coordinates]
    return at + [run[b].velocity(run.end)[k] for b in run.bodies for k in coordinates]


def two_masses(stiffness, until):
    def scene():
        made = rb.Scene()
        rail = rb.Rail(rb.Line(direction=[1, 0, 0]))
        one = made.add(rb.Particle(1.0), rail, parameter=1.0, speed=0.25)
        two = made.add(rb.Particle(2.0), rail, parameter=1.0, speed=-0.5)
        made.connect(rb.Spring(4.0), one, [0, 0, 0])
        made.connect(rb.Spring(3.0), two, [0, 0, 0])
        made.connect(rb.Spring(stiffness), one, two)
        return made, until

    def slopes(state, _):
        x, y, u, v = state
        pull = stiffness * (y - x)
        return [u, v, pull - 4.0 * x, (-3.0 * y - pull) / 2.0]

    return Problem(
        f"two masses on a rail, the spring between them of {stiffness:g} N/m, {until:g} s",
        [1.0, 1.0, 0.25, -0.5],
        until,
        {"only": Mode(slopes)},
        scene,
        lambda run: places(run, (0,)),
    )


def beads():
    """On circles of radius 1 in parallel planes 1 m apart, by angles from the lowest points."""

    def slopes(state, m):
        a, b, u, v = state
        length = m.sqrt(3.0 - 2.0 * m.cos(a - b))
        # of the energy 10 (length - 1)^2 the derivative by a
        turn = 20.0 * (length - 1.0) / length * m.sin(a - b)
        return [u, v, -G * m.sin(a) - turn, -G * m.sin(b) + turn]

    def told(state, _):
        a, b, u, v = state
        return [
            math.sin(a),
            -math.cos(a),
            math.sin(b),
            -math.cos(b),
            u * math.cos(a),
            u * math.sin(a),
            v * math.cos(b),
            v * math.sin(b),
        ]

    return Problem(
        "two beads on circles, joined by a spring, 20 s",
        [1.0, -0.5, 1.0, 1.0],
        20.0,
        {"only": Mode(slopes)},
        two_beads,
        lambda run: places(run, (0, 2)),
        groups=(slice(0, 4), slice(4, 8)),
        told=told,
    )


def chain(count=10):
    """Masses joined by springs of rest length, the first to the origin, in the plane of their fall."""

    def scene():
        made, before = rb.Scene(gravity=DOWN), [0, 0, 0]
        for i in range(count):
            mass = made.add(rb.Particle(0.1), position=[0.1 * (i + 1), 0, 0])
            made.connect(rb.Spring(100.0, rest_length=0.1), mass, before)
            before = mass
        return made, 1.0

    def slopes(state, m):
        x, z, rates = state[0 : 2 * count : 2], state[1 : 2 * count : 2], state[2 * count :]
        pulls = []
        for i in range(count):
            dx, dz = (x[i], z[i]) if i == 0 else (x[i] - x[i - 1], z[i] - z[i - 1])
            length = m.sqrt(dx * dx + dz * dz)
            factor = 1000.0 * (1.0 - 0.1 / length)
            pulls.append((factor * dx, factor * dz))
        pulls.append((0.0, 0.0))
        bend = []
        for i in range(count):
            bend += [pulls[i + 1][0] - pulls[i][0], pulls[i + 1][1] - pulls[i][1] - G]
        return [*rates, *bend]

    start = [c for i in range(count) for c in (0.1 * (i + 1), 0.0)] + [0.0] * (2 * count)
    return Problem(
        f"chain of {count} masses on springs of rest length, 1 s",
        start,
        1.0,
        {"only": Mode(slopes)},
        scene,
        lambda run: places(run, (0, 2)),
    )


def double_pendulum():
    """Two rods of 1 kg and 1 m, by their angles from the vertical."""

    def scene():
        made = rb.Scene(gravity=DOWN)
        rod = rb.shapes.rod(1.0, 1.0, [0, 0, 1])
        upper = made.add(rod, rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), angle=1.0)
        made.add(rod, rb.Revolute([0, 1, 0], at=[0, 0, -0.5], point=[0, 0, 0.5]), parent=upper, angle=0.5)
        return made, 10.0

    def slopes(state, m):
        a, b, u, v = state
        c, s = m.cos(a - b), m.sin(a - b)
        # 4/3 a'' + c/2 b'' = p, c/2 a'' + b''/3 = q
        p = -0.5 * s * v * v - 1.5 * G * m.sin(a)
        q = 0.5 * s * u * u - 0.5 * G * m.sin(b)
        d = 4.0 / 9.0 - 0.25 * c * c
        return [u, v, (p / 3.0 - 0.5 * c * q) / d, (4.0 / 3.0 * q - 0.5 * c * p) / d]

    def read(run):
        upper, lower = run.bodies
        at = [run[body].position(run.end)[k] for body in (upper, lower) for k in (0, 2)]
        return at

    def told(state, _):
        a, b = state[:2]
        x, z = -math.sin(a), -math.cos(a)
        return [x / 2, z / 2, x - math.sin(b) / 2, z - math.cos(b) / 2]

    return Problem(
        "double pendulum of two rods, 10 s",
        [1.0, 1.5, 0.0, 0.0],
        10.0,
        {"only": Mode(slopes)},
        scene,
        read,
        groups=(slice(0, 4),),
        told=told,
    )


# --- with events ---


def rough_hoop():
    """R = 1 m, from 2 rad at 6 m/s until it sticks: the angle there and when. Nine events."""

    def scene():
        made = rb.Scene(gravity=DOWN)
        circle = rb.Circle(radius=1.0, start=[0, 0, -1], toward=[1, 0, 0])
        made.add(rb.Particle(1.0), rb.Rail(circle, friction=rb.Coulomb(0.15, 0.1)), parameter=2.0, speed=6.0)
        return made, 12.0

    def press(state, m):
        return state[1] * state[1] + G * m.cos(state[0])

    def mode(way, side):
        def turned(state):
            u = state[0]
            if abs(math.sin(u)) <= 0.15 * abs(math.cos(u)):
                return None
            return f"{'-' if math.sin(u) > 0 else '+'}{'+' if math.cos(u) > 0 else '-'}", [u, 0.0]

        def slopes(state, m):
            return [state[1], -G * m.sin(state[0]) - way * side * 0.1 * press(state, m)]

        other = f"{'+' if way > 0 else '-'}{'-' if side > 0 else '+'}"
        return Mode(slopes, [(lambda x, m: x[1], -way, turned), (press, -side, lambda x: (other, list(x)))])

    def read(run):
        handle = run.bodies[0]
        x, _, z = run[handle].position(run.end)
        return [x, z, run.events.times("stick")[-1]]

    return Problem(
        "bead on a rough hoop until it sticks, 9 events",
        [2.0, 6.0],
        12.0,
        {f"{a}{b}": mode(int(a + "1"), int(b + "1")) for a in "+-" for b in "+-"},
        scene,
        read,
        first="++",
        groups=(slice(0, 2), slice(2, 3)),
        told=lambda state, last: [math.sin(state[0]), -math.cos(state[0]), last],
    )


def stick_slip():
    """On a belt of 1 m/s."""

    def caught(state):
        return ("sticks", [state[0], 1.0]) if abs(state[0]) <= 1.0 else None

    sticks = Mode(
        lambda x, m: [1.0 + 0.0 * x[0], 0.0 * x[0]], [(lambda x, m: x[0] - 1.0, 1, lambda x: ("slips", [1.0, 1.0]))]
    )
    slips = Mode(lambda x, m: [x[1], 0.5 - x[0]], [(lambda x, m: x[1] - 1.0, 1, caught)])
    return Problem(
        "stick-slip on a belt, 60 s",
        [0.0, 1.0],
        60.0,
        {"sticks": sticks, "slips": slips},
        belt,
        lambda run: places(run, (0,)),
        first="sticks",
        groups=(slice(0, 2),),
    )


def bouncing():
    def bounced(state):
        return "only", [state[0], -0.9 * state[1]]

    flight = Mode(lambda x, m: [x[1], -G + 0.0 * x[0]], [(lambda x, m: x[0], -1, bounced)])
    return Problem(
        "ball that bounces, e = 0.9, 20 s",
        [10.0, 0.0],
        20.0,
        {"only": flight},
        lambda: (ball()[0], 20.0),
        lambda run: places(run, (2,)),
        groups=(slice(0, 2),),
    )


def sliding_ladder():
    """4 m, from 1.5 rad to the floor; without friction. Its angle, and its middle's way from the wall."""
    gravity, half = 9.8125, 2.0

    def at_wall(state, m):
        return -0.75 * gravity / half * m.cos(state[0])

    def free(state, m):
        a, w = state[0], state[1]
        c = m.cos(a)
        return -half * c * (gravity - half * m.sin(a) * w * w) / (half * half * (1.0 / 3.0 + c * c))

    def wall(state, m):
        a, w = state[0], state[1]
        return -m.sin(a) * at_wall(state, m) - m.cos(a) * w * w

    def leaves(state):
        return "free", list(state)

    # the middle moves with the angle, and goes on as it was
    leaning = Mode(
        lambda x, m: [x[1], at_wall(x, m), x[3], half * wall(x, m)],
        [(wall, -1, leaves)],
    )
    sliding = Mode(lambda x, m: [x[1], free(x, m), x[3], 0.0 * x[0]])

    def told(state, _):
        a, w, x, u = state
        return [x, half * math.sin(a), u, half * math.cos(a) * w]

    return Problem(
        "ladder that leaves its wall, 2 s",
        [1.5, 0.0, half * math.cos(1.5), 0.0],
        2.0,
        {"leaning": leaning, "free": sliding},
        ladder,
        lambda run: places(run, (0, 2)),
        first="leaning",
        told=told,
    )


PROBLEMS = {
    "F": body("free body, 100 s", (1.0, 2.0, 3.0), None, (0.01, 1.0, 0.02), 0.0, 100.0, free_body),
    "T": body("heavy symmetric top, 10 s", (0.002, 0.002, 0.001), (0.0, 0.0, 0.05), SPIN, 0.3, 10.0, symmetric_top),
    "N": body("heavy body without symmetry, 5 s", MOMENTS, CENTER, SPIN, 0.3, 5.0, heavy_body),
    "N100": body("the same for 100 s", MOMENTS, CENTER, SPIN, 0.3, 100.0, lambda: (heavy_body()[0], 100.0)),
    "beads": beads(),
    "hoop": rough_hoop(),
    "masses": two_masses(5.0, 100.0),
    "stiff masses": two_masses(1e8, 1.0),
    "belt": stick_slip(),
    "ball": bouncing(),
    "ladder": sliding_ladder(),
    "double": double_pendulum(),
    "triple": triple_pendulum(),
    "four-bar": four_bar(),
    "andrews": andrews(),
    "chain": chain(),
    "chain 100": chain(100),
}
