"""What notebooks show of scenes, plans, runs, events and effects; prices and scorecards have tests of their own."""

import re
import time
from html.parser import HTMLParser

import pytest
import rbdyn as rb


class Rows(HTMLParser):
    """The rows of all tables, each a list of cells; tags that do not match fail."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.open = [], []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("td", "th"):
            self.rows[-1][-1] += data


def rows_of(thing):
    return Rows(thing._repr_html_()).rows


@pytest.fixture(scope="module")
def scene():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.shapes.sphere(1.0, 0.1), position=[0, 0, 1.1], name="ball <1>")
    rod = scene.add(rb.shapes.rod(1.0, 1.0, along=[0, 0, 1]), rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), parent=ball)
    scene.contact(ball.sphere(0.1), rb.Plane([0, 0, 1]), restitution=0.5)
    scene.constrain(rb.Rod(2.0), ball.point([0, 0, 0]), rod.point([0, 0, -1.5]))
    scene.apply(rb.Drag(linear=0.1), ball)
    scene.watch("up & down", lambda now: now[ball].velocity[2])
    return scene


def test_a_scene_has_a_row_for_each_thing(scene):
    heads, *rows = rows_of(scene)
    assert heads == ["name", "what", "where", "start"]
    assert [row[0] for row in rows] == ["ball <1>", "body 2", "load", "constraint 1", "contact 1", "up & down"]
    what = {row[0]: row[1:] for row in rows}
    assert what["ball <1>"][0].startswith("rigid body, mass 1, inertia [[0.004, 0, 0], [0, 0.004, 0]")
    assert what["ball <1>"][2] == "position [0, 0, 1.1], velocity [0, 0, 0]"
    assert what["body 2"][1] == "revolute, axis [0, 1, 0], point [0, 0, 0.5] on ball <1>"
    assert what["load"] == ["drag, linear 0.1", "ball <1>", ""]
    assert what["constraint 1"][:2] == ["rod, length 2", "ball <1>, point [0, 0, 0] - body 2, point [0, 0, -1.5]"]
    assert what["contact 1"][0] == "restitution 0.5"


def test_a_scene_with_what_is_called_back_has_its_names():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), name="ball")
    scene.apply(rb.Force(lambda t, position, velocity: [float(t), 0, 0]), ball)
    assert rows_of(scene) == [["name"], ["ball"], ["force 1"]]


def test_a_plan_says_what_is_left_out():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    scene.add(rb.Particle(1.0), velocity=[1, 0, 1], name="stone")
    rows = rows_of(rb.plan(scene))
    assert ["coordinates", "stone: x, z in the world"] in rows and ["effects", "gravity"] in rows
    assert any(row[0] == "left out" and row[1].startswith("rotation: particles") for row in rows)
    assert [row[1] for row in rows if row[0] == "size"] == ["3 variables, 0 guards, 2 instructions"]
    scene.add(rb.RigidBody(1.0, [1, 2, 3]), angular_velocity=[1, 2, 3], name="body")
    assert rb.plan(scene)._repr_html_().count("<table>") == 3  # the whole, and both parts


def test_a_run_shows_its_end_its_price_and_its_events(scene):
    run = rb.simulate(scene, until=1.0, error=1e-6)
    rows = rows_of(run)
    assert ["status", "reached end at t = 1.0 s"] in rows and ["engine", "taylor"] in rows
    assert [row for row in rows if row[0] == "estimated global error"] == [
        ["estimated global error", f"{run.error:.1e}"]
    ]
    events = [row for row in rows if len(row) == 5]
    assert events[0] == ["t [s]", "event", "of", "direction", "impulse [N s]"]
    assert [(float(row[0]), row[1], row[2]) for row in events[1:]] == [(e.time, e.kind, e.name) for e in run.events]
    assert rows_of(run.events) == events
    impact = next(event for event in run.events if event.kind == "impact")
    assert rows_of(impact)[1][:3] == [repr(impact.time), "impact", "contact 1"]
    assert rows_of(impact)[1][4] == ", ".join(f"{push:g}" for push in impact.impulse)
    rough = rb.simulate(scene, until=0.1, rtol=1e-6)
    assert ["estimated global error", "not estimated"] in rows_of(rough) and "t [s]" not in rough._repr_html_()


def test_a_run_that_is_not_certain_to_its_end_says_so():
    scene = rb.Scene()
    scene.add(rb.RigidBody(1.0, [1, 2, 3]), angular_velocity=[1e-9, 1, 0])
    with pytest.raises(rb.AccuracyError) as caught:
        rb.simulate(scene, until=100.0, engine="dop853", error=1e-12)
    run = caught.value.run
    assert ["certain until", f"t = {run.certain_until} s"] in rows_of(run)


def test_many_events_are_counted_and_quickly_shown():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])
    scene.connect(rb.Spring(1e4), ball, [0, 0, 0])
    scene.watch("passes", lambda now: now[ball].position[0])
    run = rb.simulate(scene, until=100.0)
    begin = time.perf_counter()
    text = run.events._repr_html_()
    assert time.perf_counter() - begin < 0.5
    assert text.count("<tr>") == 51 and re.search(r"<p>and (\d+) more</p>", text)[1] == str(len(run.events) - 50)


def test_effects_are_a_table():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0], velocity=[1, 0, 2])
    scene.apply(rb.Drag(linear=0.2), ball)
    table = rb.effects(scene, until=1.0)
    heads, *rows = rows_of(table)
    assert heads == ["without", "steps", "time [ms]", "difference", "gained", "lost", ""]
    assert [row[0] for row in rows] == ["nothing", "gravity", "drag"]
    assert [row[3] for row in rows[1:]] == [f"{row.difference:.1e}" for row in table.rows]


def test_equations_of_ones_own_have_tables_too():
    system = rb.System(lambda t, x: [x[1], -x[0]], [1.0, 0.0])
    assert ["variables", "x[0]; x[1]"] in rows_of(rb.plan(system))
    assert ["status", "reached end at t = 1.0 s"] in rows_of(rb.simulate(system, until=1.0))
