"""Bars in a plane, hinged to each other: as a scene, as equations of first order, and for engines of multibody
dynamics.

Bars have angles from the x axis. A point of one is the sum of arms, each turned by a bar's angle; so are velocities,
with the rates. A tree has as many freedoms as bars. A linkage closed by pins, each of which determines two bars more,
has one: its rates are multiples of that of the first bar, and so are the ways that forces go (virtual power).
"""

import math
from dataclasses import dataclass, field

import rbdyn as rb

from .problem import G, Mode, Problem


@dataclass
class Bar:
    mass: float
    com: complex
    moment: float
    at: complex  # of its hinge, in its parent's axes
    parent: int  # -1: the ground
    angle: float  # from the x axis
    rate: float = 0.0


@dataclass
class Pin:
    a: int
    on_a: complex
    b: int
    on_b: complex
    bars: tuple  # those that it determines


@dataclass
class Linkage:
    bars: list
    pins: list = field(default_factory=list)
    gravity: float = G
    torque: float = 0.0  # on the first bar
    spring: tuple = ()  # place on the ground, bar, place on it, stiffness, rest length

    def arms(self, bar, point):
        """Of a point of a bar: by bar, the arm that turns with it; -1 stands still."""
        result = {}
        while bar >= 0:
            result[bar] = result.get(bar, 0) + point
            bar, point = self.bars[bar].parent, self.bars[bar].at
        result[-1] = point
        return result

    def pin_arms(self, pin):
        one, other = self.arms(pin.a, pin.on_a), self.arms(pin.b, pin.on_b)
        return {
            j: one.get(j, 0) - other.get(j, 0) for j in (*one, *other) if one.get(j, 0) != other.get(j, 0) and j >= 0
        }

    # --- equations by hand ---

    def slopes(self, state, m):
        return self.closed(state, m)[0] if self.pins else self.open(state, m)

    def open(self, state, m):
        count = len(self.bars)
        angles, rates = state[:count], state[count:]
        cos, sin = [m.cos(a) for a in angles], [m.sin(a) for a in angles]
        arms = [self.arms(k, bar.com) for k, bar in enumerate(self.bars)]
        mass = [[0.0] * count for _ in range(count)]
        force = []
        for j in range(count):
            lever = sum(bar.mass * arms[k].get(j, 0) for k, bar in enumerate(self.bars))
            force.append(-self.gravity * (lever.real * cos[j] - lever.imag * sin[j]))
            if j == 0 and self.torque:
                force[j] += self.torque
        for j in range(count):
            for k in range(j, count):
                both = sum(
                    bar.mass * arms[i].get(j, 0).conjugate() * arms[i].get(k, 0) for i, bar in enumerate(self.bars)
                )
                if j == k:
                    mass[j][j] = both.real + self.bars[j].moment
                    continue
                c = cos[k] * cos[j] + sin[k] * sin[j]
                s = sin[k] * cos[j] - cos[k] * sin[j]
                real, imaginary = turned(both, c, s)
                mass[j][k] = mass[k][j] = real
                force[j] = force[j] + imaginary * (rates[k] * rates[k])
                force[k] = force[k] - imaginary * (rates[j] * rates[j])
        return [*rates, *solved(mass, force)]

    def closed(self, state, m):
        """Slopes of the angles and of the first bar's rate; and all rates."""
        count = len(self.bars)
        cos, sin = [m.cos(a) for a in state[:count]], [m.sin(a) for a in state[:count]]
        first = state[count]

        def arm(number, j):
            return turned(number, cos[j], sin[j])

        def across(number, j):
            x, y = arm(number, j)
            return -y, x

        def completed(value, extra):
            """What all bars have where the first has this, and pins ask for the extra."""
            values = {0: value}
            for pin, add in zip(self.pins, extra, strict=True):
                x, y = add
                columns = {}
                for j, number in self.pin_arms(pin).items():
                    if j in pin.bars:
                        columns[j] = across(number, j)
                    elif not is_zero(values[j]):
                        dx, dy = across(number, j)
                        x, y = x + dx * values[j], y + dy * values[j]
                p, q = pin.bars
                (px, py), (qx, qy) = columns[p], columns[q]
                one_over = 1.0 / (px * qy - py * qx)
                values[p] = (qx * y - qy * x) * one_over
                values[q] = (py * x - px * y) * one_over
            return [values[j] for j in range(count)]

        ways = completed(1.0, [(0.0, 0.0)] * len(self.pins))
        rates = [first, *(way * first for way in ways[1:])]
        squares = [rate * rate for rate in rates]

        def inward(arms):
            x, y = 0.0, 0.0
            for j, number in arms.items():
                if j >= 0 and number != 0:
                    ax, ay = arm(number, j)
                    x, y = x - ax * squares[j], y - ay * squares[j]
            return x, y

        def along(arms, values):
            x, y = 0.0, 0.0
            for j, number in arms.items():
                if j >= 0 and number != 0 and not is_zero(values[j]):
                    ax, ay = across(number, j)
                    x, y = x + ax * values[j], y + ay * values[j]
            return x, y

        bends = completed(0.0, [inward(self.pin_arms(pin)) for pin in self.pins])
        mass, force = 0.0, self.torque
        for k, bar in enumerate(self.bars):
            arms = self.arms(k, bar.com)
            gx, gy = along(arms, ways)
            bx, by = along(arms, bends)
            ix, iy = inward(arms)
            mass = mass + bar.mass * (gx * gx + gy * gy) + bar.moment * ways[k] * ways[k]
            force = (
                force - bar.mass * (gx * (bx + ix) + gy * (by + iy + self.gravity)) - bar.moment * ways[k] * bends[k]
            )
        if self.spring:
            place, bar, point, stiffness, rest = self.spring
            arms = self.arms(bar, point)
            x, y = arms[-1].real - place.real, arms[-1].imag - place.imag
            for j, number in arms.items():
                if j >= 0:
                    ax, ay = arm(number, j)
                    x, y = x + ax, y + ay
            length = m.sqrt(x * x + y * y)
            pull = stiffness * (1.0 - rest / length)
            gx, gy = along(arms, ways)
            force = force - pull * (x * gx + y * gy)
        return [*rates, force / mass], rates

    def start(self):
        angles = [bar.angle for bar in self.bars]
        return [*angles, *([self.bars[0].rate] if self.pins else [bar.rate for bar in self.bars])]

    def told(self, state, _):
        count = len(self.bars)
        return [*state[:count], *(self.closed(state, math)[1] if self.pins else state[count:])]

    # --- as a scene ---

    def scene(self):
        made = rb.Scene(gravity=[0, -self.gravity, 0])
        handles = []
        for bar in self.bars:
            body = rb.RigidBody(bar.mass, [bar.moment] * 3, com=[bar.com.real, bar.com.imag, 0])
            joint = rb.Revolute([0, 0, 1], at=[bar.at.real, bar.at.imag, 0])
            before = self.bars[bar.parent] if bar.parent >= 0 else Bar(0, 0, 0, 0, -1, 0.0)
            parent = {"parent": handles[bar.parent]} if bar.parent >= 0 else {}
            handles.append(made.add(body, joint, angle=bar.angle - before.angle, rate=bar.rate - before.rate, **parent))
        for pin in self.pins:
            made.constrain(
                rb.Ball(), handles[pin.a].point(in_space(pin.on_a)), handles[pin.b].point(in_space(pin.on_b))
            )
        if self.torque:
            made.apply(rb.JointTorque(self.torque), handles[0])
        if self.spring:
            place, bar, point, stiffness, rest = self.spring
            spring = rb.Spring(stiffness, rest_length=rest)
            made.connect(spring, handles[bar].point(in_space(point)), in_space(place))
        return made

    def read(self, run):
        angles, rates = [], []
        for bar, handle in zip(self.bars, run.bodies, strict=True):
            angles.append(run[handle].angle(run.end) + (angles[bar.parent] if bar.parent >= 0 else 0.0))
            rates.append(run[handle].rate(run.end) + (rates[bar.parent] if bar.parent >= 0 else 0.0))
        return angles + rates

    def problem(self, about, until):
        count = len(self.bars)
        return Problem(
            about,
            self.start(),
            until,
            {"only": Mode(self.slopes)},
            lambda: (self.scene(), until),
            self.read,
            groups=(slice(0, count), slice(count, 2 * count)),
            told=self.told,
            linkage=self,
        )


def is_zero(value):
    return isinstance(value, float) and value == 0.0


def in_space(number):
    return [complex(number).real, complex(number).imag, 0.0]


def turned(number, c, s):
    """The product of a complex number and of c + i s, without what is multiplied by zero."""
    number = complex(number)
    if number.imag == 0.0:
        return number.real * c, number.real * s
    if number.real == 0.0:
        return -number.imag * s, number.imag * c
    return number.real * c - number.imag * s, number.real * s + number.imag * c


def solved(matrix, right):
    """Symmetric and positive, by elimination."""
    matrix, right = [list(row) for row in matrix], list(right)
    count = len(right)
    for k in range(count):
        for i in range(k + 1, count):
            factor = matrix[i][k] / matrix[k][k]
            for j in range(k + 1, count):
                matrix[i][j] = matrix[i][j] - factor * matrix[k][j]
            right[i] = right[i] - factor * right[k]
    result = [None] * count
    for k in reversed(range(count)):
        rest = right[k]
        for j in range(k + 1, count):
            rest = rest - matrix[k][j] * result[j]
        result[k] = rest / matrix[k][k]
    return result


def rods(lengths, masses, angles):
    """Thin rods, end to end; angles from the x axis."""
    bars = []
    for i, (length, mass, angle) in enumerate(zip(lengths, masses, angles, strict=True)):
        at = complex(lengths[i - 1]) if i else 0j
        bars.append(Bar(mass, complex(length / 2), mass * length**2 / 12, at, i - 1, angle))
    return Linkage(bars)


def triple_pendulum():
    """Released from rest; regular for as long as it is followed."""
    down = -math.pi / 2
    return rods([1.0, 1.0, 2.0], [3.0, 1.5, 0.75], [down + 2.0, down + 1.5, down + 2.5]).problem(
        "triple pendulum of rods, 4 s", 4.0
    )


def circles_meet(one, far, other, near, side):
    """Where bars of these lengths, from `one` and from `other`, meet."""
    between = other - one
    reach = abs(between)
    x = (far**2 - near**2 + reach**2) / (2.0 * reach)
    return one + between / reach * complex(x, side * math.sqrt(far**2 - x**2))


def four_bar():
    """Crank and rocker under gravity (ground 2, crank 0.75, coupler 2, rocker 1.5)."""
    angle, rate = 0.5, 3.0
    crank = 0.75 * complex(math.cos(angle), math.sin(angle))
    meet = circles_meet(crank, 2.0, 2.0, 1.5, 1.0)
    coupler, rocker = (meet - crank), (meet - 2.0)
    bars = [
        Bar(1.0, 0.375 + 0j, 0.046875, 0j, -1, angle, rate),
        Bar(2.0, 1.0 + 0.125j, 2.0 / 3.0, 0.75 + 0j, 0, math.atan2(coupler.imag, coupler.real)),
        Bar(1.5, 0.75 + 0j, 0.28125, 2.0 + 0j, -1, math.atan2(rocker.imag, rocker.real)),
    ]
    made = Linkage(bars, [Pin(1, 2.0 + 0j, 2, 1.5 + 0j, (1, 2))], gravity=9.8125)
    for bar, value in zip(bars, made.closed(made.start(), math)[1], strict=True):
        bar.rate = value
    return made.problem("four-bar linkage under gravity, 5 s", 5.0)


def andrews():
    """Andrews' squeezing mechanism (F. Mazzia, C. Magherini, Test Set for IVP Solvers, 2008): from rest, 0.03 s."""
    fixed, far = -0.06934 - 0.00227j, -0.03635 + 0.03273j
    first = -0.0617138900142764496358948458001  # beta, with Theta = 0
    end = 0.007 * complex(math.cos(first), math.sin(first)) - 0.028 * complex(math.cos(first), math.sin(first))
    third = end - far  # from the hinge of K3 to its pin, at -0.035 i of it
    meet = circles_meet(fixed, 0.04, end, 0.02, 1.0)
    fifth, fourth = meet - fixed, end - meet
    other = circles_meet(fixed, 0.04, end, 0.02, -1.0)
    seventh, sixth = other - fixed, end - other

    def angle(number, of):
        turn = number / of
        return math.atan2(turn.imag, turn.real)

    bars = [
        Bar(0.04325, 0.00092 + 0j, 2.194e-6, 0j, -1, first),
        Bar(0.00365, -0.0115 + 0j, 4.41e-7, 0.007 + 0j, 0, first),
        Bar(0.02373, 0.01043 - 0.01874j, 5.255e-6, far, -1, angle(third, -0.035j)),
        Bar(0.0705, 0.02308 + 0.00916j, 1.169e-5, fixed, -1, angle(fifth, 0.04)),
        Bar(0.00706, -0.00579j, 5.667e-7, 0.04 + 0j, 3, angle(fourth, -0.02j)),
        Bar(0.05498, -0.00449 - 0.01228j, 1.912e-5, fixed, -1, angle(seventh, -0.04j)),
        Bar(0.00706, 0.00579 + 0j, 5.667e-7, -0.04j, 5, angle(sixth, 0.02)),
    ]
    pins = [
        Pin(1, -0.028 + 0j, 2, -0.035j, (1, 2)),
        Pin(1, -0.028 + 0j, 4, -0.02j, (3, 4)),
        Pin(1, -0.028 + 0j, 6, 0.02 + 0j, (5, 6)),
    ]
    spring = (0.014 + 0.072j, 2, 0.02 - 0.018j, 4530.0, 0.07785)
    return Linkage(bars, pins, gravity=0.0, torque=0.033, spring=spring).problem("Andrews' mechanism, 0.03 s", 0.03)
