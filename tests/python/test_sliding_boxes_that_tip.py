"""A box that slides on four or six feet and is pulled above its centre of mass tips straight over its front edge.

It slides from mu m g = c t on, and the feet at its rear press no more when the moments about the centre of mass are
those of the front edge alone: c t d + mu m g h / 2 = m g a / 2. Until then nothing leaves the floor, whatever part of
the load each foot is told to bear; the scenes are turned as a whole.
"""

import numpy as np
import pytest
import rbdyn as rb
from scipy.spatial.transform import Rotation

GRAVITY, MASS, WIDTH = 9.7, 2.3, 0.7


def pulled(turned, length, height, above, mu, rate, rows):
    x, _, z = turned.T
    scene = rb.Scene(gravity=-GRAVITY * z)
    box = scene.add(rb.shapes.box(MASS, [length, WIDTH, height]), position=height / 2 * z, attitude=turned)
    feet = {}
    for at in np.linspace(-1, 1, rows):
        for side in (-1, 1):
            place = [at * length / 2, side * WIDTH / 2, -height / 2]
            feet[at, side] = scene.contact(box.point(place), rb.Plane(z), friction=rb.Coulomb(mu))
    pull = [float(part) for part in rate * x]
    scene.apply(rb.Force(lambda t, r, v: [pull[0] * t, pull[1] * t, pull[2] * t]), box, at=[0, 0, above])
    return scene, box, feet


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("rows", [2, 3])
@pytest.mark.parametrize(
    "length, height, above, mu, rate",
    [(1.0, 0.4, 0.2, 0.3, 11.0), (0.6, 0.9, 0.31, 0.2, 5.0), (1.3, 0.2, 0.09, 0.5, 40)],
)
def test_it_tips_when_its_rear_presses_no_more(seed, rows, length, height, above, mu, rate):
    turned = np.eye(3) if seed == 0 else Rotation.random(random_state=seed).as_matrix()
    scene, box, feet = pulled(turned, length, height, above, mu, rate, rows)
    slips = mu * MASS * GRAVITY / rate
    tips = MASS * GRAVITY * (length - mu * height) / (2 * above * rate)
    assert slips < tips
    run = rb.simulate(scene, tips + 0.02, error=1e-9)
    assert [e.time for e in run.events if e.kind == "slip"] == pytest.approx([slips] * len(feet), rel=1e-12)
    opened = {e.subject: e.time for e in run.events if e.kind == "detach"}
    assert set(opened) == {foot for (at, _), foot in feet.items() if at < 1}
    assert list(opened.values()) == pytest.approx([tips] * len(opened), rel=1e-9)
    assert {e.kind for e in run.events} == {"slip", "detach"}
    far = (run[box].position(tips) - run[box].position(0.0)) @ turned[:, 0]
    assert far == pytest.approx(rate * (tips - slips) ** 3 / 6 / MASS, rel=1e-8)
