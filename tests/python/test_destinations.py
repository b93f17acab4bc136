"""Paths that are none, and files that cannot be written: one sentence, the same kind of error from all who write."""

import io
import json

import numpy as np
import pytest
import rbdyn as rb


@pytest.fixture(scope="module")
def free():
    """A scene with a free body, its handle and its run."""
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), velocity=[1, 0, 0], name="ball")
    return scene, ball, rb.simulate(scene, 1.0)


WRITERS = {
    "Trajectory.plot": lambda run, path: run.plot(path),
    "plot_path": lambda run, path: run.plot_path(path),
    "view": lambda run, path: run.view(path),
    "animate": lambda run, path: run.animate(path),
    "to_csv": lambda run, path: run.sample([0.0]).to_csv(path),
    "save": lambda run, path: run.save(path),
    "Scorecard.plot": lambda run, path: rb.verify(case="Kepler, e = 0.9", engine="dop853").plot(path),
}
SUFFIX = {"view": ".html", "animate": ".gif", "to_csv": ".csv", "save": ".npz"}


@pytest.mark.parametrize("user", WRITERS)
def test_what_cannot_be_written_is_a_refusal_that_names_the_file(user, free, tmp_path):
    for needed in {"view": ["plotly"], "to_csv": [], "save": []}.get(user, ["matplotlib"]):
        pytest.importorskip(needed)
    path = tmp_path / "nowhere" / f"a{SUFFIX.get(user, '.png')}"
    with pytest.raises(rb.InvalidInput, match="cannot be written: No such file or directory") as caught:
        WRITERS[user](free[2], path)
    assert str(caught.value).startswith(f"{user}: {str(path)!r}")


@pytest.mark.parametrize("user", [user for user in WRITERS if user != "to_csv"])
def test_a_suffix_that_is_none_is_refused_with_those_that_are(user, free, tmp_path):
    for needed in {"view": ["plotly"], "save": []}.get(user, ["matplotlib"]):
        pytest.importorskip(needed)
    with pytest.raises(rb.InvalidInput, match=r"\.foo'") as caught:
        WRITERS[user](free[2], tmp_path / "x.foo")
    assert SUFFIX.get(user, ".png") in str(caught.value) and not list(tmp_path.iterdir())


def test_a_page_is_no_animation(free, tmp_path):
    pytest.importorskip("plotly")
    with pytest.raises(rb.InvalidInput, match=r"'.*x.gif' is neither .html nor .htm; .* animate\(\)"):
        free[2].view(tmp_path / "x.gif")
    assert not list(tmp_path.iterdir())


def test_a_figure_goes_into_a_stream_as_before(free):
    pytest.importorskip("matplotlib")
    stream = io.BytesIO()
    free[2].plot(stream)
    assert stream.getvalue().startswith(b"\x89PNG")


def test_a_handle_is_no_path(free):
    pytest.importorskip("matplotlib")
    _, ball, run = free
    with pytest.raises(TypeError, match=r"Trajectory.plot: path is <Handle: ball>; .* as in plot\(None, handle\)"):
        run.plot(ball)


def test_a_free_body_has_no_phase_portrait(free):
    pytest.importorskip("matplotlib")
    _, ball, run = free
    with pytest.raises(rb.InvalidInput, match='"ball" is not on a rail, a hinge or a slide'):
        run.phase_portrait(None, ball)
    with pytest.raises(rb.InvalidInput, match="no body of this run is on a rail, a hinge or a slide"):
        run.phase_portrait()


def test_what_is_no_path_is_named(free):
    scene, _, run = free
    for call, sentence in [
        (lambda: rb.load(5), "load: path is 5; it is a string or a path"),
        (lambda: rb.save("x.json", scene), r"save: path is <Scene: .*>; .* as in save\(scene, path\)"),
        (lambda: run.sample([0.0]).to_csv(3), "to_csv: path is 3; it is a string or a path"),
    ]:
        with pytest.raises(TypeError, match=sentence):
            call()


@pytest.mark.parametrize("times", ["a", ["a"], [[0.0], [0.0, 1.0]], 1j, None])
def test_times_of_a_sample_are_numbers(times, free):
    own = rb.simulate(rb.System(lambda t, x: -x, [1.0]), 1.0)
    for run, user in ((free[2], "Sample"), (own, "SystemSample")):
        if times is None:
            assert np.array_equal(run.sample().t, run.t)
            continue
        with pytest.raises(rb.InvalidInput, match=f"^{user}: times is "):
            run.sample(times)


def test_what_is_made_by_functions_alone_says_so():
    with pytest.raises(TypeError, match=r"^Parameter: it is not made by a call of its class; rbdyn.parameter\(value\)"):
        rb.Parameter(1)
    with pytest.raises(TypeError, match="^Trajectory: it is not made by a call of its class"):
        rb.Trajectory()


def test_a_length_that_cannot_be_measured_is_told_with_its_place_in_the_file(tmp_path):
    spline = {"kind": "spline", "points": [[0, 0, 0], [1e308, 0, 0], [2, 0, 1]]}
    bead = {"name": "b", "body": {"kind": "particle", "mass": 1}, "joint": {"kind": "rail", "curve": spline}}
    path = tmp_path / "far.json"
    path.write_text(json.dumps({"format": "rbdyn scene", "version": 1, "gravity": [0, 0, 0], "bodies": [bead]}))
    with pytest.raises(rb.InvalidInput, match=r"far.json: bodies\[0\].joint.curve: spline of 3 points: the arc length"):
        rb.load(path)


def test_starts_that_are_no_mapping_are_named(free):
    with pytest.raises(rb.InvalidInput, match=r"initial is \[1, 2\]; it is a mapping of \(handle, word\)"):
        rb.simulate(free[0], 1.0, initial=[1, 2])
