"""A view as a person sees it: opened by a browser without network, played and scrubbed by the mouse.

Nothing is compared with a stored picture: where the pixels of the ball are is held against where the run has the ball.
"""

from importlib.util import find_spec

import browser
import numpy as np
import pytest
import rbdyn as rb
from numpy.testing import assert_allclose

pytestmark = [
    pytest.mark.skipif(not find_spec("plotly"), reason="plotly is not installed: no views"),
    pytest.mark.skipif(not find_spec("matplotlib"), reason="matplotlib is not installed: nothing reads a picture"),
    pytest.mark.skipif(browser.found() is None, reason=f"there is no browser: none of {', '.join(browser.NAMES)}"),
]

RADIUS = 0.3


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    """A ball that bounces once in a plane, seen at right angles to it: its run, and its view in a browser."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.shapes.sphere(1.0, RADIUS), position=[0, 0, 2.0], velocity=[1.0, 0, 0], name="ball")
    scene.contact(ball.sphere(RADIUS), rb.Plane([0, 0, 1]), restitution=0.7)
    run = rb.simulate(scene, 1.0)
    folder = tmp_path_factory.mktemp("view")
    run.view(folder / "ball.html")
    with browser.Page(folder / "ball.html", folder / "profile") as page:
        page.wait_for("document.querySelectorAll('.updatemenu-button').length == 6")
        page.wait_for("document.querySelector('.slider-label') != null")
        yield run, run[ball], page


def shown_time(page):
    """The time that the page says it shows."""
    return float(page.evaluate("document.querySelector('.slider-label').textContent").split()[2])


def ball_in(picture):
    """The pixels of the ball: how many, and their middle (x, y), y downwards."""
    red, green, blue = np.moveaxis(picture[110:495, :715], -1, 0)
    y, x = np.nonzero((red < 60) & (green > 70) & (green < 150) & (blue > 110))
    return len(x), np.array([x.mean(), y.mean()])


def scrub(page, part):
    """Takes the grip of the slider and drags it to a part of its way, 0 to 1."""
    x, y, width = page.evaluate(
        "(r => [r.x, r.y + r.height / 4, r.width])"
        "(document.querySelector('.slider-rail-touch-rect').getBoundingClientRect())"
    )
    page.mouse("mousePressed", x + 0.3 * width, y)
    page.mouse("mouseMoved", x + 0.5 * (0.3 + part) * width, y)
    page.mouse("mouseMoved", x + part * width, y)
    page.mouse("mouseReleased", x + part * width, y)


def press(page, label):
    x, y = page.evaluate(
        f"(r => [r.x + r.width / 2, r.y + r.height / 2])([...document.querySelectorAll('.updatemenu-button')]"
        f".find(b => b.textContent == '{label}').getBoundingClientRect())"
    )
    page.click(x, y)


def test_scrubbing_moves_the_ball_to_where_the_run_has_it(opened):
    run, motion, page = opened
    times, middles, counts = [], [], []
    for part in (0.01, 0.25, 0.5, 0.75, 0.99):
        scrub(page, part)
        page.wait_for(f"Math.abs(document.querySelector('.slider-label').textContent.split(' ')[2] - {part}) < 0.02")
        count, middle = ball_in(page.picture())
        times.append(shown_time(page))
        counts.append(count)
        middles.append(middle)
    x, _, z = motion.position(np.array(times)).T
    middles = np.array(middles)
    scale = np.polyfit(x, middles[:, 0], 1)[0]
    assert scale > 30
    # the floor is a line below, and forces are drawn over the ball: their pixels are not its
    assert_allclose(middles[:, 0] - middles[0, 0], scale * (x - x[0]), atol=3)
    assert_allclose(middles[:, 1] - middles[0, 1], -scale * (z - z[0]), atol=4)
    assert_allclose(counts, np.pi * (RADIUS * scale) ** 2, rtol=0.15)


def test_playing_moves_the_ball_until_it_is_paused(opened):
    _, motion, page = opened
    scrub(page, 0.01)
    _, before = ball_in(page.picture())
    start = shown_time(page)
    press(page, "play")
    # on what draws by software a second may take a minute; the time shown goes on, also after the slider was dragged
    page.wait_for("document.querySelector('.slider-label').textContent.split(' ')[2] > 0.2", 300.0)
    press(page, "pause")
    page.wait_for(
        "new Promise(done => {const l = () => document.querySelector('.slider-label').textContent;"
        " const now = l(); setTimeout(() => done(l() == now), 300)})"
    )
    _, after = ball_in(page.picture())
    paused = shown_time(page)
    assert start < 0.05 < 0.2 < paused < 1.0
    moved = motion.position(paused) - motion.position(start)
    # of one scale in both directions
    assert_allclose(after[1] - before[1], -(after[0] - before[0]) * moved[2] / moved[0], atol=5)
    assert after[0] - before[0] > 5


def test_nothing_is_asked_of_anyone(opened):
    _, _, page = opened
    (itself,) = (address for address in page.requests if not address.startswith(("data:", "blob:")))
    assert itself.startswith("file:") and itself.endswith("/ball.html")
