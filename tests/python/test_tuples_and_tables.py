"""Named tuples of arrays answer what tuples do, and tables whose arrays do not fit say which."""

import copy
import pickle

import numpy as np
import pytest
import rbdyn as rb
from rbdyn.verification.scorecard import Row

# --- named tuples ---


@pytest.fixture
def axes():
    return rb.Curve(lambda u: [np.cos(u), np.sin(u), u]).frenet(0.3)


def test_a_field_is_found_by_its_numbers(axes):
    for place, field in enumerate(axes):
        assert field in axes and list(field) in axes and field.copy() in axes
        assert axes.index(field) == axes.index(list(field)) == place and axes.count(field) == 1
    for other in ("1j", 3, None, axes[0][:2], -axes[0], object()):
        assert other not in axes and axes.count(other) == 0
    with pytest.raises(ValueError, match="Frenet.index: 3 is none of tangent, normal, binormal"):
        axes.index(3)
    with pytest.raises(ValueError, match="is none of"):
        axes.index(axes.tangent, 1)


def test_two_are_equal_where_all_their_numbers_are(axes):
    same, other = copy.deepcopy(axes), axes._replace(normal=-axes.normal)
    assert axes == same and same == pickle.loads(pickle.dumps(axes)) and not axes != same
    assert axes != other and not axes == other
    assert axes != axes[:2] and axes != 3 and axes == tuple(axes)
    assert rb.Axis(np.array([1.0, 2, 3]), np.zeros(3)) != rb.Axis(np.array([1.0, 2, 4]), np.zeros(3))


# --- tables ---


@pytest.fixture
def ball_and_run():
    scene = rb.Scene(gravity=[0, 0, -9.81])
    ball = scene.add(rb.Particle(1.0), name="ball")
    return ball, rb.simulate(scene, 1.0)


@pytest.fixture
def state_run():
    return rb.simulate(rb.System(lambda t, x: [x[1], -x[0]], [1.0, 0.0], names=["q", "p"]), 1.0)


def test_a_sample_whose_arrays_do_not_fit_says_which(ball_and_run, tmp_path):
    ball, run = ball_and_run
    sample = run.sample([0.0, 0.5, 1.0])
    sample.to_csv(tmp_path / "whole.csv")
    assert len((tmp_path / "whole.csv").read_text().splitlines()) == 4
    for name, value, sentence in (
        (
            "position",
            np.zeros((2, 3)),
            r"ball.position has shape \(2, 3\); of 3 times it is \(3, 3\), one row for each",
        ),
        ("velocity", np.zeros((3, 5)), r"ball.velocity has shape \(3, 5\); of 3 times it is \(3, 3\)"),
        ("force", [1.0], r"ball.force is \[1.0\]; it is an array with a row for each time"),
    ):
        changed = run.sample([0.0, 0.5, 1.0])
        changed[ball][name] = value
        for write in (lambda c=changed: c.to_csv(tmp_path / "x.csv"), lambda c=changed: c.to_pandas()):
            with pytest.raises(rb.InvalidInput, match="Sample: " + sentence):
                write()
    sample.t = [0.0]
    with pytest.raises(rb.InvalidInput, match=r"Sample: t is \[0.0\]; it is an array of times"):
        sample.to_csv(tmp_path / "x.csv")
    with pytest.raises(AttributeError, match="Sample: it has no '_values'; run.sample\\(times\\) makes one"):
        rb.Sample.__new__(rb.Sample).to_csv(tmp_path / "x.csv")
    assert not (tmp_path / "x.csv").exists()


def test_a_quantity_that_a_body_does_not_have_is_refused_with_those_it_has(ball_and_run):
    ball, run = ball_and_run
    with pytest.raises(
        rb.InvalidInput, match="ball has no quantity 'p'; it has position, velocity, acceleration, force"
    ):
        run.sample().unit(ball, "p")
    with pytest.raises(rb.InvalidInput, match=r"ball has no quantity \[\]"):
        run.sample().unit(ball, [])
    with pytest.raises(rb.InvalidInput, match=r"Sample: \[\] is no body or coupling of this run"):
        run.sample()[[]]


def test_a_variable_that_there_is_not_is_named(state_run):
    sample = state_run.sample([0.0, 1.0])
    np.testing.assert_array_equal(sample[-1], sample["p"])
    np.testing.assert_array_equal(list(sample), sample.x.T)
    for place in (2, -3, 2**63):
        with pytest.raises(IndexError, match=f"SystemSample: there is no variable at {place}; there are 2: q, p"):
            sample[place]
    for what in (len, None, True, 1.0, slice(0, 1)):
        with pytest.raises(rb.InvalidInput, match="SystemSample: a variable is .*; it is a name or a place, from 0"):
            sample[what]


def test_the_table_of_a_system_that_does_not_fit_says_so(state_run, tmp_path):
    for name, value in (("names", ["q"]), ("t", np.zeros(3)), ("x", 3)):
        sample = state_run.sample([0.0, 1.0])
        setattr(sample, name, value)
        for use in (
            lambda s=sample: s.to_csv(tmp_path / "x.csv"),
            lambda s=sample: s[0],
            lambda s=sample: s.to_pandas(),
        ):
            with pytest.raises(rb.InvalidInput, match="SystemSample: x .*; of . times and . variables it is"):
                use()


def test_a_path_with_half_a_character_is_refused(ball_and_run, state_run):
    _, run = ball_and_run
    for write in (
        lambda: run.sample().to_csv("\ud800"),
        lambda: state_run.sample().to_csv("\ud800"),
        lambda: rb.save(run, "\ud800.npz"),
        lambda: rb.load("\ud800.json"),
    ):
        with pytest.raises(rb.InvalidInput, match=r"path is '\\ud800.*half a character \(a surrogate\)"):
            write()


def test_many_of_what_are_no_runs_is_refused_when_it_is_made(ball_and_run):
    _, run = ball_and_run
    for arguments, sentence in (
        ((3, [], {}, 0.0, 1.0), "Many: runs is 3; it is a list of runs"),
        (([3], [None], {}, 0.0, 1.0), r"Many: runs is \[3\]; it is a list of runs"),
        (([run], ["x"], {}, 0.0, 1.0), r"Many: errors is \['x'\]; it is a list of exceptions"),
        (([run], [], {}, 0.0, 1.0), "Many: errors has 0 members and runs 1; give one for each run"),
        (([run], [None], 3, 0.0, 1.0), "Many: vary is 3; it is the mapping"),
    ):
        with pytest.raises((TypeError, rb.InvalidInput), match=sentence):
            rb.Many(*arguments)
    many = rb.Many([run, None], [None, None], {}, 0.0, 1.0)
    assert "energy" in dir(many) and many.status == ["reached end", "not begun"]
    assert "status" in dir(rb.Many.__new__(rb.Many))


def test_a_scorecard_of_what_are_no_rows_is_refused_when_it_is_made():
    row = dict(case="a", subject="s", engine="e", what="w", known=1.0, ours=[1.0, 2.0], error=0.0, asked=1e-9,
               estimate=0.0, seconds=0.1, status="held", reason="")  # fmt: skip
    assert "<td>1_(+1)</td>" in rb.Scorecard((Row(**row),), 1.0)._repr_html_()
    with pytest.raises(TypeError, match=r"Scorecard: rows is \(3,\); it is a tuple of Row"):
        rb.Scorecard((3,), 1.0)
    for name, value in (("case", 3), ("error", "x"), ("known", "x"), ("ours", [1, [2]])):
        with pytest.raises(TypeError, match=f"Row: {name} is .*; it is"):
            Row(**{**row, name: value})
