"""verify(): what it holds, that it fails where an answer is wrong, and that refusals are listed and counted."""

import dataclasses
import inspect
import json
import math
import re
import signal
import threading

import numpy as np
import pytest
import rbdyn as rb
from rbdyn.command_line import main
from rbdyn.verification import linkages, rolling, systems
from rbdyn.verification.case import CASES, Answer, Solve, case, kinds, says
from rbdyn.verification.rows import ROWS, cases_of, table
from rbdyn.verification.runner import judged


@pytest.fixture(scope="module")
def card():
    """The quick set in all engines."""
    return rb.verify()


@pytest.fixture
def entered():
    """Enters cases for one test."""
    before = dict(CASES)
    yield lambda name, **what: case(name, subject="s", row="r", hard="h", **what)
    CASES.clear()
    CASES.update(before)


def fall(known):
    """A case of a fall from 1 m, and what is taken for its answer."""

    def answers(solve):
        scene = rb.Scene(gravity=[0, 0, -8])
        ball = scene.add(rb.Particle(1.0), position=[0, 0, 1])
        scene.watch("floor", lambda now: now[ball].position[2])
        yield Answer("lands at", solve(scene, 1.0).events.times("floor"), [known])

    return answers


def test_the_quick_set_is_held_in_less_than_45_s(card):
    assert card.passed and not card.interrupted, str(card)
    assert card.seconds < 45
    assert len(card.cases) >= 40 and card.unheld == ()
    assert card.cases == tuple(one.name for one in CASES.values() if one.quick)


@pytest.mark.cvode
def test_every_engine_holds_what_it_claims_and_says_why_where_it_does_not(card):
    for name in card.cases:
        held = {row.engine for row in card if row.case == name and row.status == "held"}
        assert held == (set(CASES[name].holds) or {"-"}), name
    refused = card.of("refused")
    assert refused and all(len(row.reason) > 20 for row in refused)
    assert f"{len(refused)} refused" in str(card)
    assert all(f"refused: {row.case}: " in str(card) for row in refused)


@pytest.mark.cvode
def test_what_is_held_is_within_what_was_asked_and_within_what_the_run_tells(card):
    for row in card.of("held"):
        # what the digits of an answer leave is at most 1e-3, of two ends that a run creeps up to
        assert row.error <= row.asked + 1e-3, row
        assert 0 <= row.digits <= 16
    told = [row for row in card.of("held") if not math.isnan(row.estimate)]
    assert len(told) > 150
    assert np.mean([row.error <= row.estimate + 1e-15 for row in told]) > 0.95


@pytest.mark.cvode
def test_a_wrong_answer_fails_and_so_does_the_exit_code(entered, capsys):
    entered("a right fall")(fall(0.5))
    entered("a wrong fall")(fall(0.5 * (1 + 1e-8)))
    assert rb.verify(case="a right fall").passed
    card = rb.verify(case="a wrong fall")
    assert not card.passed and card.unheld == ()  # the least engines cannot tell
    missed = card.of("missed")
    assert {row.engine for row in missed} >= {"taylor", "dop853"}
    assert all("lands at is off by" in row.reason for row in missed)
    assert all("off by 1.0e-08" in row.reason for row in missed if row.engine in ("taylor", "dop853"))
    assert "missed: a wrong fall, taylor: lands at is off by" in str(card)
    assert main(["verify", "--case", "a wrong fall"]) == 1
    assert "NOT passed" in capsys.readouterr().out
    assert main(["verify", "--case", "a right fall"]) == 0


def test_an_error_beyond_what_the_run_tells_is_missed_though_it_is_within_what_was_asked(entered):
    entered("told too little", error=1e-6)(fall(0.5 * (1 + 1e-9)))
    row = judged(CASES["told too little"], "taylor")
    assert row.status == "missed" and "told was" in row.reason
    assert row.error < row.asked


def test_a_case_that_no_engine_holds_or_that_breaks_fails(entered):
    def refused(solve):
        solve(rb.Scene(), -1.0)
        yield Answer("never", 0.0, 0.0)

    def breaks(solve):
        yield Answer("none", [][0], 0.0)

    entered("refused by all")(refused)
    entered("breaks")(breaks)
    entered("says nothing")(lambda solve: iter(()))
    card = rb.verify(case="refused by all")
    assert not card.passed and len(card.of("refused")) == 5 and card.unheld == ("refused by all",)
    for name in ("breaks", "says nothing"):
        card = rb.verify(case=name)
        assert not card.passed and len(card.of("failed")) == 5


def test_answers_tell_their_errors():
    assert Answer("", 1.5, 1.0).error == 0.5 and Answer("", 3.0, 2.0, scale=4.0).error == 0.25
    assert Answer("", 1e-300, 0.0).error == math.inf and Answer("", 0.0, 0.0).error == 0.0
    assert Answer("", [1.0], [1.0, 2.0]).error == math.inf and Answer("", [], []).error == 0.0
    assert Answer("", math.nan, 1.0).error == math.inf and Answer("", [0.0, math.nan], [0.0, 1.0]).error == math.inf
    assert Answer("", [], [1.0]).error == math.inf
    assert says("mass is -1", "mass", "-1").error == 0.0 and says("mass is -1", "mass", "nan").error > 0.1
    run = rb.simulate(rb.System(lambda t, x: [-x[0]], [1.0]), 1.0)
    assert kinds(run).error == 0.0 and kinds(run, "watch").error == math.inf


def test_each_row_of_the_list_has_a_case_and_each_case_a_row(root):
    assert all(cases_of(subject, row) for subject, rows in ROWS.items() for row in rows)
    assert all(one.row in ROWS[one.subject] for one in CASES.values())
    assert table() in (root / "docs" / "verification.md").read_text()


def test_numbers_that_are_copied_from_references_stand_in_their_files(root):
    compared = 0
    for one in CASES.values():
        if not one.source.startswith("reference "):
            continue
        file = root / "tests" / "reference" / f"{one.source.split()[1].rstrip(',')}.json"
        there = [float(number) for number in re.findall(r'"-?(\d+\.\d+(?:e-?\d+)?)"', file.read_text())]
        for number in re.findall(r"\d+\.\d{14,}", inspect.getsource(one.answers)):
            assert any(abs(value - float(number)) <= 2e-16 * value for value in there), (one.name, number)
            compared += 1
    assert compared > 40


@pytest.mark.parametrize(
    "answers",
    [
        lambda solve: linkages.walk(20, solve),
        lambda solve: linkages.turn(300, solve),
        lambda solve: systems.kicked(1000, solve),
    ],
)
def test_short_forms_of_the_slow_cases_are_held(answers):
    solve = Solve("taylor", 1e-8)
    found = list(answers(solve))
    assert len(found) >= 2
    for answer in found:
        # the scales of gaps and drifts are of the slow ones
        assert answer.error <= solve.error + answer.given, answer


def by_hand(lowest, mass, inertia, turn, omega, times, **friction):
    """The axis z of a body on the table and its angular velocity, world, at times: by equations of their own."""
    pytest.importorskip("scipy")
    from rolling_by_hand import Body

    body = Body(mass, inertia, lowest, rolling.G, **friction)
    rows = body.run(turn, omega, [0.0, *times], v=[0, 0, 0] if "mu" in friction else None)[1:]
    return rows[:, [2, 5, 8]], rows[:, 15:]


def test_numbers_of_bodies_that_roll_are_those_of_equations_written_apart():
    pytest.importorskip("scipy")
    from rolling_by_hand import disc, ellipsoid

    inertia = np.array([[2.5e-4, -7.5e-5, 0], [-7.5e-5, 1.5e-3, 0], [0, 0, 1.7e-3]])
    surface = ellipsoid([0.2, 0.03125, 0.02], [0, 0, 0.01])
    omega = [0.0078125, 0.0078125, -3.0]
    # the first of its numbers: the second takes SciPy half a minute
    t, known = rolling.RATTLES[0]
    _, turns = by_hand(surface, 1.0, inertia, np.eye(3), omega, [t])
    assert np.allclose(turns, [known], rtol=0, atol=3e-9)

    top = rolling.TOP
    surface = ellipsoid([top["radius"]] * 3, [0, 0, top["off"]])
    t, axis, known = rolling.TURNS_OVER[0]
    inertia = np.diag(rolling.MOMENTS)
    axes, turns = by_hand(surface, top["mass"], inertia, rolling.tilted(0.8, 0.6), [0, 120, 160], [t], mu=0.1)
    assert np.allclose(axes, [axis], rtol=0, atol=1e-7)
    assert np.allclose(turns, [known], rtol=0, atol=2e-5)

    inertia = 0.4 * 0.0375**2 / 4 * np.diag([1, 1, 2])
    times = [t for t, *_ in rolling.FALLING]
    start = rolling.tilted(0.96, 0.28)
    axes, turns = by_hand(disc(0.0375), 0.4, inertia, start, [0, 17.119190011991417, 0], times, rolling=0.004)
    assert np.allclose(axes, [axis for _, axis, _ in rolling.FALLING], rtol=0, atol=1e-8)
    assert np.allclose(turns, [known for *_, known in rolling.FALLING], rtol=0, atol=2e-7)


def test_periods_of_linkages_are_those_of_quadratures():
    # of the flywheel linkage: T(angle) of a rate of 1, and the trapezoid rule over a turn, which is periodic
    angle = np.arange(400, dtype=np.longdouble) * 2 * np.pi / 400
    size, coupler, rocker, ground = (np.longdouble(x) for x in (0.0625, 2, 1.5, 2))
    end = size * np.exp(1j * angle)
    rate = 1j * end
    reach = abs(ground - end)
    x = (coupler**2 - rocker**2 + reach**2) / (2 * reach)
    meet = end + (ground - end) / reach * (x + 1j * np.sqrt(coupler**2 - x**2))
    # (v - rate) is across the coupler, v across the rocker
    along, arm = meet - end, 1j * (meet - ground)
    v = arm * (rate * along.conj()).real / (arm * along.conj()).real
    kinetic = 5 + (abs(rate) ** 2 + (rate * v.conj()).real + 2 * abs(v) ** 2) / 6
    assert np.sqrt(kinetic / kinetic[0]).mean() == pytest.approx(linkages.FLYWHEEL, rel=1e-15)


def test_one_case_one_engine_and_names_that_are_none():
    card = rb.verify(case="belt", engine="taylor")
    assert len(card) == 1 and card.rows[0].engine == "taylor"
    assert len(rb.verify(case="flips", engine="closed form").cases) == 3
    with pytest.raises(rb.InvalidInput, match="no case is called 'bellt'.*nearest is 'belt'"):
        rb.verify(case="bellt")
    with pytest.raises(rb.InvalidInput, match="engine is 'tailor'"):
        rb.verify(engine="tailor")
    for full in ("belt", 1, None):
        with pytest.raises(rb.InvalidInput, match="full is .*; it is True or False"):
            rb.verify(full=full, case="belt")
    assert not rb.verify(case="belt", engine="closed form").passed
    fractions = []
    rb.verify(case="flips", engine="closed form", progress=fractions.append)
    assert fractions == [1 / 3, 2 / 3, 1.0]


def test_a_card_shows_itself(card, tmp_path):
    assert str(card).startswith("Scorecard: passed, ")
    page = card._repr_html_()
    assert page.count("<tr") == 1 + len(card) and "Zeno ball" in page
    rows = card.to_dicts()
    assert len(rows) == len(card) and json.dumps(rows[0]["ours"])
    pytest.importorskip("matplotlib")
    card.plot(str(tmp_path / "card.png"))
    assert (tmp_path / "card.png").stat().st_size > 10_000
    pandas = pytest.importorskip("pandas")
    assert isinstance(card.to_pandas(), pandas.DataFrame)
    assert not dataclasses.replace(card, interrupted=True).passed and not dataclasses.replace(card, rows=()).passed


def test_ctrl_c_ends_it_with_what_there_is(entered):
    def slow(solve):
        signal.raise_signal(signal.SIGINT)
        yield from fall(0.5)(solve)

    entered("z 1", holds=())(fall(0.5))
    entered("z 2", holds=())(slow)
    assert threading.current_thread() is threading.main_thread()
    card = rb.verify(case="z ")
    assert card.interrupted and not card.passed and card.cases == ("z 1",)


def test_json_and_a_figure_on_the_command_line(capsys, tmp_path):
    assert main(["verify", "--case", "Zeno ball", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["passed"] is True and data["unheld"] == []
    held = [row for row in data["rows"] if row["status"] == "held"]
    assert [row["engine"] for row in held] == ["taylor"] and held[0]["digits"] > 10
    assert sum(row["status"] == "refused" for row in data["rows"]) == 4
    assert main(["verify", "--case", "belt", "--engine", "taylor"]) == 0
    assert "1 held" in capsys.readouterr().out
    assert main(["verify", "--case", "no such"]) == 2
    assert "no case is called 'no such'" in capsys.readouterr().err
    pytest.importorskip("matplotlib")
    assert main(["verify", "--case", "belt", "--figure", str(tmp_path / "a.svg")]) == 0
    assert (tmp_path / "a.svg").exists()
