"""A box on corners that never slip tips straight over an edge, and slides where both would have to be pulled.

Until the edge presses no more the box turns about it: its energy gives the time, a quadrature. Let go it would move
into the plane, so it slides, and with friction without bound nothing presses: all forces are along the plane, so that
its centre falls freely until it lies on its side. Several corners slide as with the coefficient 2^20, as near to that
limit as one over it.
"""

import math

import numpy as np
import pytest
import rbdyn as rb
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
# width, depth and height [m], how the plane leans [rad], how quickly the box turns as it starts [rad/s]
BOXES = [
    ((0.3, 0.8, 0.86), 0.75, 0.0),
    ((0.57, 0.95, 0.96), 0.0, 3.6),
    ((0.32, 0.586, 0.916), 0.507, 2.358),
    ((0.728, 0.396, 0.815), 0.254, 3.325),
    ((0.26, 0.97, 0.632), 0.929, 2.117),
    ((0.249, 0.274, 0.971), 0.904, 1.351),
    ((0.508, 0.648, 0.696), 0.3, 1.597),
    ((0.368, 0.993, 0.781), 1.042, 0.198),
]
# the same, where each of the two corners alone would be held up by its own friction: there are several motions
SEVERAL = [((0.689, 0.227, 0.349), 0.81, 2.282), ((0.685, 0.227, 0.544), 0.822, 0.625)]


def falls(size, lean, rate):
    """When the edge presses no more, and when the box lies on its side."""
    width, _, height = size
    along, across = GRAVITY * math.sin(lean), GRAVITY * math.cos(lean)
    arm, first = math.hypot(width, height) / 2, math.atan2(height, width)
    inertia = (width**2 + height**2) / 12 + arm**2

    def square(turn):  # of the angular velocity
        x, z = math.cos(first) - math.cos(first + turn), math.sin(first + turn) - math.sin(first)
        return rate**2 + 2 * arm * (along * x - across * z) / inertia

    def pressure(turn):
        angle = first + turn
        quickens = arm * (along * math.sin(angle) - across * math.cos(angle)) / inertia
        return across + arm * (math.cos(angle) * quickens - math.sin(angle) * square(turn))

    turns = np.linspace(1e-6, math.pi / 2, 1000)
    last = next(i for i, turn in enumerate(turns) if pressure(turn) < 0)
    free = brentq(pressure, turns[last - 1], turns[last], xtol=1e-15)
    # a start at rest is a root in the quadrature: by the root of the turn
    time, _ = quad(lambda u: 2 * u / math.sqrt(square(u * u)), 0, math.sqrt(free), epsabs=1e-13, epsrel=1e-12)
    height_then = arm * math.sin(first + free)
    speed = arm * math.cos(first + free) * math.sqrt(square(free))
    return time, time + (speed + math.sqrt(speed**2 + 2 * across * (height_then - width / 2))) / across


def scene_of(size, lean, rate, turned, friction):
    width, depth, height = size
    scene = rb.Scene(gravity=turned @ [GRAVITY * math.sin(lean), 0, -GRAVITY * math.cos(lean)])
    box = scene.add(
        rb.shapes.box(1.0, size),
        position=turned @ [-width / 2, 0, height / 2],
        velocity=turned @ (np.array([height / 2, 0, width / 2]) * rate),
        angular_velocity_world=turned @ [0, rate, 0],
        attitude=turned,
    )
    for x in (-width / 2, width / 2):
        for y in (-depth / 2, depth / 2):
            for z in (-height / 2, height / 2):
                scene.contact(box.point([x, y, z]), rb.Plane(turned @ [0, 0, 1]), friction=friction)
    return scene, box


@pytest.mark.parametrize("is_turned", [False, True])
@pytest.mark.parametrize("box", BOXES)
def test_it_slides_where_its_edge_would_have_to_be_pulled(box, is_turned):
    turned = Rotation.random(random_state=3).as_matrix() if is_turned else np.eye(3)
    presses, lies = falls(*box)
    scene, _ = scene_of(*box, turned, rb.Coulomb(math.inf))
    run = rb.simulate(scene, lies + 0.01, error=1e-9)
    slips = [e.time for e in run.events if e.kind == "slip"][:2]
    assert slips == pytest.approx([presses, presses], rel=1e-9)
    # as near to the limit as the coefficient
    lands = [e.time for e in run.events if e.kind == "land"][:2]
    assert lands == pytest.approx([lies, lies], rel=1e-7)


@pytest.mark.parametrize("box", SEVERAL)
def test_several_motions_are_named(box):
    """A force at one of the corners alone turns the body so that the other one parts: this, too, satisfies the laws."""
    presses, _ = falls(*box)
    scene, _ = scene_of(*box, np.eye(3), rb.Coulomb(math.inf))
    with pytest.raises(rb.IntegrationError, match="Painleve") as caught:
        rb.simulate(scene, presses + 0.1, error=1e-9)
    assert caught.value.run.end == pytest.approx(presses, rel=1e-6)
