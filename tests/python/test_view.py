"""Pictures that move: what a view and an animation have in them is what the run says, and a view needs nothing else."""

import html.parser
import json
from importlib.util import find_spec

import numpy as np
import pytest
import rbdyn as rb
from numpy.testing import assert_allclose, assert_array_equal
from rbdyn import outlines
from rbdyn.command_line import main
from rbdyn.drawing import drawing_of
from rbdyn.recorded import evaluated

needs_plotly = pytest.mark.skipif(not find_spec("plotly"), reason="plotly is not installed: no views")
needs_matplotlib = pytest.mark.skipif(not find_spec("matplotlib"), reason="matplotlib is not installed: no animations")


@pytest.fixture(scope="module")
def bouncing():
    """A ball that bounces on a plane, on a spring to a box that a hinge holds, and a bead on a rail that moves."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    body = rb.shapes.box(2.0, [0.4, 0.6, 0.8]).shifted([0.05, -0.1, 0.2])
    door = scene.add(body, rb.Revolute([0, 0, 1], at=[2, 0, 1], point=[-0.2, 0, 0]), rate=1.0)
    ball = scene.add(rb.shapes.sphere(1.0, 0.1), position=[0, 0, 0.6], velocity=[0.1, 0, 0], name="ball")
    spring = scene.connect(rb.Spring(3.0), ball, door.point([0.2, 0.3, 0]))
    floor = scene.contact(ball.sphere(0.1), rb.Plane([0, 0, 1]), restitution=0.7)

    def turned(t):
        c, s = np.cos(t), np.sin(t)
        return [[c, -s, 0], [s, c, 0], [0, 0, 1]], [0.3 * t, 0, 0.5]

    hoop = rb.Rail(rb.Circle(0.5, start=[1, 0, 0], toward=[0, 0, 1], center=[0, 1, 0]), motion=turned)
    bead = scene.add(rb.Particle(0.2), hoop, parameter=1.0)
    return rb.simulate(scene, 2.0), door, ball, bead, spring, floor


def falling():
    scene = rb.Scene([0, 0, -9.81])
    scene.add(rb.Particle(1.0), velocity=[1, 0, 0])
    return scene


def argument(text, call, number):
    """An argument of a call in a page's script, that is JSON."""
    start = text.rindex(call + "(") + len(call) + 1
    decoder = json.JSONDecoder()
    for _ in range(number + 1):
        while text[start] in " \n\t,":
            start += 1
        if text[start] == "'":
            start = text.index("'", start + 1) + 1
        else:
            value, start = decoder.raw_decode(text, start)
    return value


def page_of(run, tmp_path, **options):
    path = tmp_path / "motion.html"
    run.view(path, **options)
    return path.read_text(encoding="utf-8")


@needs_plotly
def test_a_view_asks_nothing_of_the_network(bouncing, tmp_path):
    text = page_of(bouncing[0], tmp_path)
    asked, scripts = [], []

    class Tags(html.parser.HTMLParser):
        def handle_starttag(self, tag, attributes):
            asked.extend(value for name, value in attributes if name in ("src", "href"))
            if tag in ("link", "iframe", "img"):
                asked.append(tag)
            if tag == "script":
                scripts.append(tag)

    Tags().feed(text)
    assert asked == [] and len(scripts) >= 2
    # the renderer is in it
    assert len(text) > 2_000_000 and "mesh3d" in text
    assert [path.name for path in tmp_path.iterdir()] == ["motion.html"]


@needs_plotly
def test_the_frames_of_a_view_are_the_motion_at_uniform_times(bouncing, tmp_path):
    run, door, ball, bead, spring, _ = bouncing
    text = page_of(run, tmp_path)
    data, layout = argument(text, "Plotly.newPlot", 1), argument(text, "Plotly.newPlot", 2)
    frames = argument(text, "Plotly.addFrames", 1)
    times = np.linspace(0.0, 2.0, 101)  # 2 s are played in 4, at 25 a second
    assert [frame["name"] for frame in frames] == [str(k) for k in range(101)]
    for k, time in enumerate(times):
        named = {data[i]["name"]: part for i, part in zip(frames[k]["traces"], frames[k]["data"], strict=True)}
        centers = np.array([named["bodies"][axis] for axis in "xyz"]).T
        expected = [run[door].center_of_mass(time), run[ball].center_of_mass(time), run[bead].position(time)]
        assert_array_equal(centers, expected)
        corners = np.array([named[door.name][axis] for axis in "xyz"]).T
        own = np.array([[x, y, z] for x in (-0.2, 0.2) for y in (-0.3, 0.3) for z in (-0.4, 0.4)])
        placed = run[door].center_of_mass(time) + own @ run[door].rotation_matrix(time).T
        gaps = np.linalg.norm(corners[:, None] - placed, axis=2)
        assert gaps.min(axis=0).max() < 1e-5 and gaps.min(axis=1).max() < 1e-5
        ends = np.array([named["spring 1"][axis] for axis in "xyz"]).T
        held = run[door].point([0.2, 0.3, 0], time)[0]
        assert_allclose(ends, [run[ball].center_of_mass(time), held], atol=1e-5)
        assert named["now"]["x"] == [time, time]
    (slider,) = layout["sliders"]
    assert [step["args"][0] for step in slider["steps"]] == [[str(k)] for k in range(101)]
    assert_allclose([float(step["label"]) for step in slider["steps"]], times, rtol=1e-4)
    (menu,) = layout["updatemenus"]
    assert [button["label"] for button in menu["buttons"]] == ["play", "pause", "x 0.25", "x 0.5", "x 2", "x 4"]
    assert menu["buttons"][0]["args"][1]["frame"]["duration"] == 40


@needs_plotly
def test_events_are_on_the_line_of_time(bouncing, tmp_path):
    run = bouncing[0]
    assert len(run.events) >= 2
    (marks,) = (one for one in argument(page_of(run, tmp_path), "Plotly.newPlot", 1) if one["name"] == "events")
    drawing = drawing_of(run, "view", 25.0, None)
    for k, time in enumerate(drawing.times):
        past = [f"{event.kind}: {event.name}" for event in run.events if event.time <= time]
        assert drawing.last_event(k) == (past[-1] if past else "")
    assert marks["x"] == [event.time for event in run.events]
    assert marks["text"] == [f"{event.kind}: {event.name}" for event in run.events]


@needs_plotly
def test_a_view_has_equal_axes_and_is_shown_by_notebooks(bouncing):
    figure = bouncing[0].view(fps=5)
    scene = figure.layout.scene
    assert scene.aspectmode == "manual" and len(figure.frames) == 21
    scales = [scene.aspectratio[a] / np.ptp(scene[f"{a}axis"].range) for a in "xyz"]
    assert_allclose(scales, scales[0], rtol=1e-12)
    assert hasattr(figure, "_repr_mimebundle_")


def test_arrows_are_forces_on_one_scale_from_where_they_act(bouncing):
    run, door, ball, bead, _, floor = bouncing
    drawing = drawing_of(run, "view", 25.0, None)
    arrows = {(one.kind, one.name): one for one in drawing.arrows}
    times = drawing.times
    assert_array_equal(arrows["reaction", door.name].vectors, run[door].reaction(times))
    assert_allclose(arrows["reaction", door.name].feet, np.tile([2.0, 0, 1], (len(times), 1)), atol=1e-12)
    assert_array_equal(arrows["force", "ball"].vectors, run[ball].force(times))
    assert_array_equal(arrows["contact", floor.name].vectors, run[floor].force(times))
    assert_allclose(arrows["contact", floor.name].feet, run[ball].center_of_mass(times) - [0, 0, 0.1], atol=1e-15)
    assert_array_equal(arrows["reaction", bead.name].feet, run[bead].position(times))
    longest = max(np.linalg.norm(one.vectors, axis=1).max() for one in drawing.arrows)
    assert 0.1 * drawing.size < drawing.newton * longest < 0.5 * drawing.size
    feet, tips = drawing.arrow_tips("contact", 7)
    assert_array_equal(tips, feet + drawing.newton * run[floor].force(times[7]))


def away(point, line):
    """The distance of a point from a line of pieces."""
    a, b = line[:-1], line[1:]
    along = np.clip(np.sum((point - a) * (b - a), axis=1) / np.sum((b - a) ** 2, axis=1), 0, 1)
    return np.linalg.norm(point - a - along[:, None] * (b - a), axis=1).min()


def test_rails_pass_through_what_is_on_them(bouncing):
    curves = [
        rb.Line(direction=[1, 2, 3], point=[1, 0, 0]),
        rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0]),
        rb.Helix(radius=0.5, pitch=0.1, start=[1, 0, 0], toward=[0, 1, 0]),
        rb.Parabola(a=0.7, x=[1, 0, 0], y=[0, 0, 1]),
        rb.Cycloid(radius=0.5, x=[1, 0, 0], y=[0, 0, 1]),
        rb.Polynomial([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.5]], domain=(-3, 3)),
        rb.Spline([[0, 0, 0], [1, 0, 0.2], [2, 1, 0], [3, 1, 0.5]], slopes={0: [1, 0, 0], 3: [1, 0.5, 0]}),
        rb.Spline([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], closed=True),
        rb.Curve(lambda u: [u, np.sin(u), 0.2 * u**2], domain=(-4, 4)),
        rb.Curve(lambda u: [u, np.where(u > 0, u**3, 0.0), np.hypot(u, 1.0)]),
    ]
    scene = rb.Scene(gravity=[0, 0, -1.0])
    for i, curve in enumerate(curves):
        scene.add(rb.Particle(1.0), rb.Rail(curve), parameter=0.7, speed=0.3, name=f"bead {i}")
    for run in (rb.simulate(scene, 1.0), bouncing[0]):
        drawing = drawing_of(run, "view", 5.0, None)
        rails = {rail.name: rail.points for rail in drawing.rails}
        guided = [handle for handle in run.bodies if "parameter" in run[handle].quantities]
        assert len(rails) == len(guided) > 0
        for handle in guided:
            points = rails[f"rail of {handle.name}"]
            size = np.ptp(points[0], axis=0).max()
            if handle.name in ("bead 1", "bead 7"):
                # closed curves close
                assert_allclose(points[0, -1], points[0, 0], atol=1e-12)
            for k, time in enumerate(drawing.times):
                line = points[min(k, len(points) - 1)]
                # chords of 1/200 of a curve leave it by the square of that
                assert away(run[handle].position(time), line) < 3e-4 * size, (handle.name, time)


def test_functions_of_files_are_evaluated_as_recorded():
    g = rb.parameter(1.5, name="g")

    def f(x, y):
        return [
            np.sin(x) * np.cosh(y) / (2 + np.cos(x)),
            np.where(x > y, np.sqrt(x * x + 1), np.floor(y)),
            np.arctan2(y, x) + np.sign(x) * g,
            np.tanh(x) + np.sinh(y) - np.exp(-x) + np.log(2 + y * y),
            (x * x + 1) ** 1.7 + np.linalg.norm([x, y, 1.0]) + (x * x + 1) ** y + np.expm1(x),
            np.log1p(x * x) + np.arcsinh(y) + np.arctanh(0.5 * np.tanh(x)),
        ]

    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[0.1, 0.2, 0.3])
    function = rb.Function(f)
    scene.apply(rb.Force(lambda t, r, v: [*function(r[0], r[1])[:3]]), ball)
    scene.apply(rb.Force(lambda t, r, v: function(r[0], r[1])[3:]), ball)
    contents = json.loads(scene.__getstate__()[0])
    chance = np.random.default_rng(4)
    inputs = chance.normal(size=(7, 50))
    first, second = (load["function"] for load in contents["loads"])
    values = [one["value"] for one in contents["parameters"]]
    made = np.hstack([evaluated(first, values, *inputs), evaluated(second, values, *inputs)])
    assert_allclose(made, [function(*row) for row in inputs[1:3].T], rtol=1e-13, atol=1e-14)


def test_outlines_have_the_inertia_of_their_bodies():
    box = rb.shapes.box(3.0, [1.0, 0.5, 0.2])
    axes = rb.EulerAngles(theta=0.4, psi=1.0, phi=-0.3).rotation_matrix
    body = box.rotated(axes).shifted([1.0, 2.0, 3.0])
    outline = outlines.of_inertia(body)
    back = (outline.vertices - body.com) @ axes
    assert_allclose(np.sort(np.ptp(back, axis=0)), [0.2, 0.5, 1.0], rtol=1e-9)
    assert_allclose(np.ptp(back, axis=0), [1.0, 0.5, 0.2], rtol=1e-9)
    ball = outlines.of_inertia(rb.shapes.sphere(2.0, 0.3))
    assert_allclose(np.linalg.norm(ball.vertices, axis=1), 0.3, rtol=1e-12)
    rod = outlines.of_inertia(rb.shapes.rod(1.0, 2.0, [1, 0, 0]))
    assert_allclose(np.ptp(rod.vertices, axis=0), [2.0, 0.04, 0.04], rtol=1e-9)


def test_surfaces_are_closed_and_bodies_are_drawn_as_what_touches_of_them():
    for outline in (outlines.ellipsoid([1, 2, 3], around=32, up=16), outlines.box([1, 2, 3])):
        edges = np.sort(np.vstack([outline.triangles[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))]), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    attitude = rb.EulerAngles(theta=0.3, psi=0.2, phi=0.7)
    scene = rb.Scene(gravity=[0, 0, -9.81])
    egg = scene.add(rb.shapes.ellipsoid(1.0, [0.3, 0.2, 0.1]), position=[0, 0, 2])
    scene.contact(egg.ellipsoid([0.3, 0.2, 0.1], center=[0.1, 0, 0], attitude=attitude.quaternion), rb.Plane([0, 0, 1]))
    coin = scene.add(rb.shapes.disc(1.0, 0.25, [0, 0, 1]), position=[1, 0, 2])
    scene.contact(coin.disc(0.25, [0, 0, 1]), rb.Plane([0, 0, 1]))
    drawing = drawing_of(rb.simulate(scene, 0.1), "view", 25.0, None)
    own = (drawing.solids[0].outline.vertices - [0.1, 0, 0]) @ attitude.rotation_matrix / [0.3, 0.2, 0.1]
    assert_allclose(np.linalg.norm(own, axis=1), 1.0, rtol=1e-12)
    rim = np.linalg.norm(drawing.solids[1].outline.vertices[1:], axis=1)
    assert_allclose(rim, 0.25, rtol=1e-12)
    # two contacts with one plane show it once
    assert len(drawing.obstacles) == 1
    assert_allclose(drawing.obstacles[0][1].vertices[:, 2], 0.0, atol=1e-12)


def test_loops_and_trees_are_drawn():
    scene = rb.Scene(gravity=[0, -9.81, 0])
    plate = rb.RigidBody(1.0, [0.02, 0.02, 0.04], com=[0, -0.5, 0])
    upper = scene.add(plate, rb.Revolute([0, 0, 1]), angle=0.5)
    lower = scene.add(plate, rb.Revolute([0, 0, 1], at=[0, -1, 0]), parent=upper, angle=-0.3)
    pin = scene.constrain(rb.Ball(), lower.point([0, -1, 0]))
    run = rb.simulate(scene, 1.0)
    drawing = drawing_of(run, "view", 25.0, None)
    hinge = run[upper].point([0, -1, 0], drawing.times)[0]
    arrows = {(one.kind, one.name): one for one in drawing.arrows}
    assert_allclose(arrows["reaction", lower.name].feet, hinge, atol=1e-12)
    assert_array_equal(arrows["reaction", pin.name].vectors, run[pin].force(drawing.times))
    assert_allclose(np.ptp(arrows["reaction", pin.name].feet, axis=0), 0, atol=1e-9)


@needs_matplotlib
def test_an_animation_has_its_frames(bouncing, tmp_path):
    image = pytest.importorskip("PIL.Image", reason="Pillow is not installed: nothing reads a GIF")
    bouncing[0].animate(tmp_path / "motion.gif", fps=5)
    with image.open(tmp_path / "motion.gif") as gif:
        assert gif.n_frames == 21 and gif.info["duration"] == 200
    bouncing[0].animate(tmp_path / "slow.gif", fps=10, speed=2.0)
    with image.open(tmp_path / "slow.gif") as gif:
        assert gif.n_frames == 11 and gif.info["duration"] == 100


def test_frames_are_600_at_most_and_long_motions_are_played_in_24_seconds():
    scene = rb.Scene()
    scene.add(rb.Particle(1.0), velocity=[1, 0, 0])
    run = rb.simulate(scene, 1e6, start=10.0)
    for fps, speed, count, playing in (
        (25, None, 600, 24),
        (5, None, 121, 24),
        (25, 1e5, 251, 10),
        (100, 1e3, 600, 1e3),
    ):
        drawing = drawing_of(run, "view", fps, speed)
        assert len(drawing.times) == count and drawing.times[0] == 10.0 and drawing.times[-1] == run.end
        assert drawing.interval * (count - 1) == pytest.approx(playing, rel=1e-4)


def test_a_scene_that_calls_back_is_drawn_by_where_its_bodies_are():
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[1, 0, 0])
    scene.apply(rb.Force(lambda t, r, v: [float(-r[0]), 0.0, 0.0], trace=False), ball)
    drawing = drawing_of(rb.simulate(scene, 1.0, rtol=1e-8), "view", 25.0, None)
    assert_allclose(drawing.solids[0].positions[:, 0], np.sin(drawing.times), atol=1e-6)
    assert "called back" in drawing.notes[0]


@needs_matplotlib
@needs_plotly
def test_pictures_that_cannot_be_made_say_why(bouncing, tmp_path):
    run = bouncing[0]
    for options, words in (({"fps": 0}, "view: fps is 0"), ({"speed": float("nan")}, "view: speed is nan")):
        with pytest.raises(rb.InvalidInput, match=words):
            run.view(**options)
    with pytest.raises(rb.InvalidInput, match="neither .gif nor .mp4"):
        run.animate(tmp_path / "motion.mov")
    for make, path in ((run.view, "there/is/none.html"), (run.animate, "there/is/none.gif")):
        with pytest.raises(rb.InvalidInput, match="cannot be written"):
            make(tmp_path / path, fps=1)
    scene = falling()
    scene.apply(rb.Drag(0.0, 0.3), scene.bodies[0])
    with pytest.raises(rb.InvalidInput, match='view: .* a run of keep="end"'):
        rb.simulate(scene, 1.0, keep="end").view()


@needs_plotly
def test_the_command_line_writes_views(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fall.py").write_text(
        "import rbdyn as rb\nscene = rb.Scene([0, 0, -9.81])\nscene.add(rb.Particle(1.0), name='stone')\nuntil = 1.0\n"
    )
    assert main(["view", "fall.py"]) == 0
    assert capsys.readouterr().out == "wrote fall.html\n"
    frames = argument((tmp_path / "fall.html").read_text(encoding="utf-8"), "Plotly.addFrames", 1)
    assert frames[-1]["data"][0]["z"] == [pytest.approx(-9.81 / 2, rel=1e-12)]
    assert main(["run", "fall.py", "--save", "fall.npz"]) == 0
    assert main(["view", "fall.npz", "--output", "again.html", "--fps", "1"]) == 0
    frames = argument((tmp_path / "again.html").read_text(encoding="utf-8"), "Plotly.addFrames", 1)
    assert len(frames) == 5
    assert main(["view", "fall.npz", "--until", "3"]) == 2
    assert "leave out --until" in capsys.readouterr().err
    assert main(["view", "fall.py", "--output", "fall.txt"]) == 2
    assert "ends in .html, .gif or .mp4" in capsys.readouterr().err


@needs_matplotlib
def test_paths_are_where_the_bodies_go(bouncing, tmp_path):
    run, door, ball, bead, *_ = bouncing
    (axes,) = run.plot_path(tmp_path / "space.png").axes
    times = np.linspace(0.0, 2.0, len(axes.lines[0].get_data_3d()[0]))
    assert_array_equal(np.transpose(axes.lines[0].get_data_3d()), run[door].center_of_mass(times))
    assert_array_equal(np.transpose(axes.lines[4].get_data_3d()), run[bead].position(times))
    (axes,) = run.plot_path(plane="zx").axes
    assert_array_equal(axes.lines[2].get_xydata(), run[ball].center_of_mass(times)[:, [2, 0]])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("z [m]", "x [m]")
    assert (tmp_path / "space.png").stat().st_size > 10_000
    for plane in ("xx", "xw", "xyz", "", 3):
        with pytest.raises(rb.InvalidInput, match="plot_path: plane is"):
            run.plot_path(plane=plane)


@needs_matplotlib
def test_a_phase_portrait_is_an_ellipse_of_an_oscillator_and_is_broken_where_the_rate_jumps():
    scene = rb.Scene()
    slide = scene.add(rb.shapes.sphere(2.0, 0.1), rb.Prismatic([1, 0, 0]), displacement=0.3)
    scene.connect(rb.Spring(8.0), slide, [0, 0, 0])
    (axes,) = rb.simulate(scene, 4.0).phase_portrait().axes
    x, v = axes.lines[0].get_xydata().T
    assert_allclose(x**2 + (v / 2) ** 2, 0.09, rtol=1e-8)
    assert np.isfinite(x).all() and v.max() > 0.59 and v.min() < -0.59

    scene = rb.Scene(gravity=[0, 0, -9.81])
    slide = scene.add(rb.shapes.sphere(1.0, 0.1), rb.Prismatic([0, 0, 1]), displacement=1.0)
    scene.contact(slide.sphere(0.1), rb.Plane([0, 0, 1]), restitution=0.5)
    run = rb.simulate(scene, 0.8)
    (impact,) = run.events.times("impact")
    z, v = run.phase_portrait(handle=slide).axes[0].lines[0].get_xydata().T
    (gap,) = np.flatnonzero(np.isnan(v))
    assert v[gap - 1] == run[slide].rate(impact, side="before") and v[gap + 1] == run[slide].rate(impact)
    assert v[gap + 1] == pytest.approx(-0.5 * v[gap - 1], rel=1e-9)
    with pytest.raises(rb.InvalidInput, match="no body of this run is on a rail"):
        rb.simulate(falling(), 1.0).phase_portrait()
