"""The scenes of the benchmarks: each a function that gives (scene, seconds).

F: free body, 100 s. T: heavy symmetric top, 10 s. N: heavy body without symmetry, 5 s. hoop: a bead on a rough hoop,
6 s. belt: stick-slip, 60 s. ladder: it leaves its wall, 2 s. ball: it bounces to rest, 30 s. chain: 100 masses joined
by springs of rest length, 1 s. beads: two on circles, joined by a spring, 20 s. double: a double pendulum, 10 s.
drag: a particle on a spring, with drag. called: the same, its drag called back.

Stiff ones: mass: on a stiff damped spring, 5 s. pair: two masses, a soft spring and one 1e5 times as stiff with a
damper, 5 s. creep: a mass on a spring in something thick, 20 s. hinge: two rods, their hinge stiff and damped, 10 s.
links: 10 masses joined by stiff damped springs, 2 s. fading: drag that fades, 20 s. ringing: a stiff spring that
nothing damps, which is fast and not stiff, 5 s.
"""

import math

import numpy as np
import rbdyn as rb

DOWN = [0, 0, -9.81]


def free_body():
    scene = rb.Scene()
    scene.add(rb.RigidBody(1.0, [1.0, 2.0, 3.0]), angular_velocity=[0.01, 1.0, 0.02])
    return scene, 100.0


def top(moments, com, until):
    """Thrown about its axis, which leans, with its point held."""
    body = rb.RigidBody(0.5, com=com, inertia=moments, inertia_about="origin")
    scene = rb.Scene(gravity=DOWN)
    scene.add(body, rb.Spherical(), attitude=rb.EulerAngles(0.3, 0, 0), angular_velocity=[0, 0, 300.0])
    return scene, until


def heavy_body():
    return top([0.0022, 0.0019, 0.001], [0.01, 0.005, 0.05], 5.0)


def hoop():
    scene = rb.Scene(gravity=DOWN)
    circle = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])
    scene.add(rb.Particle(0.5), rb.Rail(circle, friction=rb.Coulomb(0.4, 0.1)), speed=7.0)
    return scene, 6.0


def belt():
    scene = rb.Scene(gravity=[0, 0, -1.0])
    rail = rb.Rail(rb.Line(direction=[1, 0, 0]), friction=rb.Coulomb(1.0, 0.5), drive=1.0)
    block = scene.add(rb.Particle(1.0), rail, parameter=0.0, speed=1.0)
    scene.connect(rb.Spring(stiffness=1.0), block, [0, 0, 0])
    return scene, 60.0


def stiff_pair():
    scene = rb.Scene(gravity=DOWN)
    a = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 0.5, 0])
    b = scene.add(rb.Particle(1.0), position=[2, 0, 0], velocity=[0, -0.5, 0])
    scene.connect(rb.Spring(10.0, rest_length=0.5), a, [0, 0, 0])
    scene.connect(rb.Spring(1e6, rest_length=1.0, damping=1e6), a, b)
    return scene, 5.0


def chain(count=100):
    scene = rb.Scene(gravity=DOWN)
    before = [0, 0, 0]
    for i in range(count):
        mass = scene.add(rb.Particle(0.1), position=[0.1 * (i + 1), 0, 0])
        scene.connect(rb.Spring(100.0, rest_length=0.1), mass, before)
        before = mass
    return scene, 1.0


def ladder():
    theta, length = 1.5, 4.0
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    place = [length / 2 * math.cos(theta), length / 2 * math.sin(theta)]
    planar = rb.Planar(x=[1, 0, 0], y=[0, 0, 1])
    rod = scene.add(rb.shapes.rod(10.0, length, [1, 0, 0]), planar, position=place, angle=math.pi - theta)
    scene.contact(rod.point([-length / 2, 0, 0]), rb.Plane(normal=[0, 0, 1]))
    scene.contact(rod.point([length / 2, 0, 0]), rb.Plane(normal=[1, 0, 0]))
    return scene, 2.0


def ball():
    scene = rb.Scene(gravity=DOWN)
    point = scene.add(rb.Particle(1.0), position=[0, 0, 10.0])
    scene.contact(point, rb.Plane(normal=[0, 0, 1]), restitution=0.9)
    return scene, 30.0


def symmetric_top():
    return top([0.002, 0.002, 0.001], [0, 0, 0.05], 10.0)


def two_beads():
    scene = rb.Scene(gravity=DOWN)
    handles = []
    for y, start in ((0.0, 1.0), (1.0, -0.5)):
        circle = rb.Circle(radius=1.0, center=[0, y, 0], start=[0, 0, -1], toward=[1, 0, 0])
        handles.append(scene.add(rb.Particle(1.0), rb.Rail(circle), parameter=start, speed=1.0))
    scene.connect(rb.Spring(20.0, rest_length=1.0), *handles)
    return scene, 20.0


def double_pendulum(scene=None, second=0.5):
    scene = scene or rb.Scene(gravity=DOWN)
    rod = rb.shapes.rod(1.0, 1.0, [0, 0, 1])
    upper = scene.add(rod, rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), angle=1.0)
    lower = scene.add(rod, rb.Revolute([0, 1, 0], at=[0, 0, -0.5], point=[0, 0, 0.5]), parent=upper, angle=second)
    return scene, 10.0, lower


def drag(force=None):
    scene = rb.Scene(gravity=DOWN)
    mass = scene.add(rb.Particle(0.5), position=[1, 0, 0], velocity=[0, 1, 0])
    scene.connect(rb.Spring(20.0, rest_length=0.5), mass, [0, 0, 0])
    scene.apply(force or rb.Drag(quadratic=0.1), mass)
    return scene, 20.0


def drag_called_back():
    def law(t, r, v):
        x, y, z = (float(part) for part in v)
        speed = math.sqrt(x * x + y * y + z * z)
        return [-0.1 * speed * x, -0.1 * speed * y, -0.1 * speed * z]

    return drag(rb.Force(law))


def on_stiff_spring(stiffness=1e6, damping=2e3):
    scene = rb.Scene(gravity=DOWN)
    mass = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 0.5, 0])
    scene.connect(rb.Spring(stiffness, rest_length=1.0, damping=damping), mass, [0, 0, 0])
    return scene, 5.0


def ringing():
    return on_stiff_spring(damping=0.0)


def creeping(load=None):
    scene = rb.Scene(gravity=DOWN)
    mass = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[0, 0.5, 0])
    scene.connect(rb.Spring(1e3, rest_length=0.5), mass, [0, 0, 0])
    scene.apply(load or rb.Drag(linear=1e4), mass)
    return scene, 20.0


def fading():
    return creeping(rb.Force(lambda t, r, v: -1e4 * np.exp(-t) * v))


def stiff_hinge():
    scene, until, lower = double_pendulum(second=0.0)
    scene.apply(rb.TorsionSpring(1e4, damping=1e3), lower)
    return scene, until


def stiff_links():
    scene = rb.Scene(gravity=DOWN)
    before = [0, 0, 0]
    for i in range(10):
        mass = scene.add(rb.Particle(0.1), position=[0.1 * (i + 1), 0, 0])
        scene.connect(rb.Spring(1e5, rest_length=0.1, damping=100.0), mass, before)
        before = mass
    return scene, 2.0


# the price lists of docs/cost.md
PRICED = {
    "F": free_body,
    "N": heavy_body,
    "hoop": hoop,
    "belt": belt,
    "stiff": stiff_pair,
    "chain": chain,
    "ladder": ladder,
    "ball": ball,
}

SMOOTH = {
    **PRICED,
    "T": symmetric_top,
    "beads": two_beads,
    "double": lambda: double_pendulum()[:2],
    "drag": drag,
    "called": drag_called_back,
}
del SMOOTH["stiff"]
STIFF = {
    "mass": on_stiff_spring,
    "pair": stiff_pair,
    "creep": creeping,
    "hinge": stiff_hinge,
    "links": stiff_links,
    "fading": fading,
    "ringing": ringing,
}
