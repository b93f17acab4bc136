"""Curves as Python sees them: geometry for a number, for an array, and rules for what makes a curve."""

import numpy as np
import pytest
import rbdyn as rb

CIRCLE = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0], center=[1, 2, 3])
HELIX = rb.Helix(radius=3.0, pitch=8 * np.pi, start=[1, 0, 0], toward=[0, 1, 0])
QUADRATIC = rb.Polynomial([[0, 0, 0], [1, 0, 0], [0, 0, 1]], domain=(-2, 2))
PARABOLA = rb.Parabola(a=0.75, x=[1, 0, 0], y=[0, 0, 1], vertex=[0, 1, 0])
CYCLOID = rb.Cycloid(radius=0.5, x=[1, 0, 0], y=[0, 0, 1])
POINTS = [[0, 0, 0], [1, 0.5, 0], [1.5, 1.5, 0.25], [1, 2, 1], [0, 2.25, 1.5]]
SPLINE = rb.Spline(POINTS)
ROUND = rb.Spline(POINTS, closed=True)
SINE = rb.Curve(lambda u: [u, np.sin(u), 0.2 * u**2], domain=(-2, 2))
LINE = rb.Line(direction=[3, 0, 4], point=[0, 1, 0])
ALL = [CIRCLE, HELIX, QUADRATIC, PARABOLA, CYCLOID, SPLINE, ROUND, SINE, LINE]
# closed forms of a few operations: some units in the last place
EXACT = 1e-14


def test_a_circle_begins_at_start_and_turns_toward():
    np.testing.assert_allclose(CIRCLE.position(0.0), [1, 2, 2.5], rtol=EXACT)
    np.testing.assert_allclose(CIRCLE.position(np.pi / 2), [1.5, 2, 3], rtol=EXACT)


def test_the_length_of_a_turn_is_the_circumference():
    assert CIRCLE.length(0, 2 * np.pi) == pytest.approx(np.pi, rel=EXACT)
    np.testing.assert_allclose(CIRCLE.length(0, [1, 2]), [0.5, 1.0], rtol=EXACT)


def test_a_helix_has_the_curvature_and_torsion_of_the_textbook():
    # radius a = 3, rise b = 4: a/(a^2 + b^2), b/(a^2 + b^2)
    np.testing.assert_allclose(HELIX.curvature([0.0, 5.0]), [3 / 25, 3 / 25], rtol=EXACT)
    np.testing.assert_allclose(HELIX.torsion([0.0, 5.0]), [4 / 25, 4 / 25], rtol=EXACT)


def test_a_parabola_and_a_cycloid_have_the_curvature_and_length_of_the_textbook():
    u = np.array([-1.0, 0.0, 0.5])
    np.testing.assert_allclose(PARABOLA.curvature(u), 1.5 / (1 + (1.5 * u) ** 2) ** 1.5, rtol=EXACT)
    np.testing.assert_allclose(CYCLOID.curvature(u), 0.5 / np.cos(u / 2), rtol=EXACT)
    assert CYCLOID.length(-np.pi, np.pi) == pytest.approx(4.0, rel=EXACT)


def test_a_spline_passes_through_its_points_and_a_closed_one_round_after_round():
    k = np.arange(5)
    np.testing.assert_allclose(SPLINE.position(k), POINTS, atol=EXACT)
    np.testing.assert_allclose(ROUND.position(k - 15), POINTS, atol=EXACT)
    assert SPLINE.domain == (0.0, 4.0) and not SPLINE.closed
    assert ROUND.domain == (-np.inf, np.inf) and ROUND.closed


def test_a_spline_has_the_slopes_it_is_given_and_curves_after_a_straight_at_once():
    rail = rb.Spline([[0, 0, 0], [1, 0, 0], [2, 0.5, 0], [2.5, 1.5, 0]], slopes={1: [1, 0, 0]})
    assert rail.curvature(0.999) == 0.0 and rail.curvature(1.0) > 0.1
    np.testing.assert_allclose(rail.frenet(1.0).tangent, [1, 0, 0], atol=EXACT)
    assert list(rail.slopes) == [1]
    np.testing.assert_array_equal(rail.slopes[1], [1, 0, 0])


def test_a_curve_may_be_any_function_in_numpy():
    helix = rb.Curve(lambda u: np.array([3 * np.cos(u), 3 * np.sin(u), 4 * u]))
    u = np.linspace(-5, 5, 11)
    np.testing.assert_allclose(helix.position(u), HELIX.position(u), atol=4 * EXACT)
    np.testing.assert_allclose(helix.torsion(u), HELIX.torsion(u), rtol=EXACT)
    np.testing.assert_allclose(helix.frenet(u).normal, HELIX.frenet(u).normal, atol=EXACT)
    assert SINE.domain == (-2.0, 2.0)
    assert SINE.curvature(0.0) == pytest.approx(0.4 / 2, rel=EXACT)  # r' = (1, 1, 0), r'' = (0, 0, 0.4)

    def ellipse(u):
        return [2 * np.cos(u), np.sin(u), 0]

    around = rb.Curve(ellipse, domain=(0, 2 * np.pi), closed=True)
    assert around.closed and repr(around) == "<Curve: curve of ellipse>"
    assert around.length(0, 4 * np.pi) == pytest.approx(2 * around.length(0, 2 * np.pi), rel=EXACT)


def test_a_bead_runs_along_a_curve_of_the_users():
    # down a well: the energy says how fast
    scene = rb.Scene(gravity=[0, 0, -10])
    well = rb.Curve(lambda u: [u, 0, 1 - np.exp(-(u**2))])
    bead = scene.add(rb.Particle(mass=2.0), rb.Rail(well), parameter=-1.0, speed=0.0)
    run = rb.simulate(scene, until=3.0, error=1e-10)
    t = np.linspace(0, 3, 50)
    height = run[bead].position(t)[:, 2]
    np.testing.assert_allclose(run[bead].speed(t) ** 2, 20 * (1 - np.exp(-1) - height), atol=1e-8)


@pytest.mark.parametrize("curve", ALL, ids=repr)
def test_a_curve_gives_a_vector_for_a_number_and_rows_for_an_array(curve):
    assert curve.position(0.3).shape == (3,)
    assert curve.position([0.1, 0.2]).shape == (2, 3)
    assert curve.position(np.zeros((4, 5))).shape == (4, 5, 3)
    assert isinstance(curve.curvature(0.3), float)
    assert curve.torsion([0.1, 0.2]).shape == (2,)
    assert isinstance(curve.length(0, 1), float)


@pytest.mark.parametrize("curve", ALL, ids=repr)
def test_the_frame_of_a_curve_is_orthonormal_and_right_handed(curve):
    frame = curve.frenet(np.linspace(-1, 1, 9))
    tangent, normal, binormal = frame
    assert frame.tangent.shape == (9, 3)
    np.testing.assert_allclose(np.cross(tangent, normal), binormal, atol=EXACT)
    np.testing.assert_allclose(np.sum(normal**2, axis=1), 1.0, rtol=EXACT)
    assert curve.frenet(0.0).normal.shape == (3,)


def test_lines_go_on_for_ever_and_a_polynomial_ends_where_it_is_told():
    assert LINE.domain == (-np.inf, np.inf)
    assert QUADRATIC.domain == (-2.0, 2.0)
    assert CIRCLE.closed and not HELIX.closed


def test_curves_of_the_same_numbers_are_equal():
    assert rb.Line([1, 0, 0]) == rb.Line([1, 0, 0])
    assert hash(rb.Line([1, 0, 0])) == hash(rb.Line([1, 0, 0]))
    assert rb.Line([1, 0, 0]) != rb.Line([0, 1, 0])
    assert rb.Line([1, 0, 0]) != 3


def test_the_numbers_a_curve_was_made_from_can_be_read():
    assert CIRCLE.radius == 0.5 and HELIX.pitch == 8 * np.pi
    np.testing.assert_array_equal(CIRCLE.center, [1, 2, 3])
    np.testing.assert_array_equal(QUADRATIC.coefficients, [[0, 0, 0], [1, 0, 0], [0, 0, 1]])
    np.testing.assert_array_equal(PARABOLA.vertex, [0, 1, 0])
    assert PARABOLA.a == 0.75 and CYCLOID.radius == 0.5
    np.testing.assert_array_equal(SPLINE.points, POINTS)
    assert repr(PARABOLA) == "Parabola(a=0.75, x=[1, 0, 0], y=[0, 0, 1], vertex=[0, 1, 0])"
    for curve in (PARABOLA, CYCLOID, ROUND, rb.Spline(POINTS, slopes={1: [1, 0, 0]})):
        assert eval(repr(curve), {**vars(rb)}) == curve
    assert repr(LINE) == "Line(direction=[3, 0, 4], point=[0, 1, 0])"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rb.Circle(radius=-1, start=[1, 0, 0], toward=[0, 1, 0]), "radius is -1"),
        (lambda: rb.Circle(radius=1, start=[1, 0, 0], toward=[2, 0, 0]), "parallel"),
        (lambda: rb.Line([0, 0, 0]), "zero"),
        (lambda: rb.Line([1, 0]), r"Line: direction has shape \(2,\); a vector has three components"),
        (lambda: rb.Line([1, 0, np.nan]), "nan"),
        (lambda: rb.Line("x"), "'x'"),
        (lambda: rb.Line([1j, 0, 0]), "numbers"),
        (lambda: rb.Polynomial([1, 2, 3]), r"shape \(3,\)"),
        (lambda: rb.Polynomial([[0, 0, 0], [0, 0, 0]]), "single point"),
        (lambda: rb.Polynomial([[0, 0, 0], [1, 0, 0]], domain=(1, 0)), "domain"),
        (lambda: rb.Parabola(a=0, x=[1, 0, 0], y=[0, 1, 0]), "use Line"),
        (lambda: rb.Parabola(a=1, x=[1, 0, 0], y=[2, 0, 0]), "parallel to x"),
        (lambda: rb.Cycloid(radius=0, x=[1, 0, 0], y=[0, 1, 0]), "radius is 0"),
        (lambda: rb.Spline([[0, 0, 0]]), "number of points is 1"),
        (lambda: rb.Spline([0, 1, 2]), r"Spline: points has shape \(3,\)"),
        (lambda: rb.Spline([[0, 0, 0], [0, 0, 0]]), "must differ"),
        (lambda: rb.Spline(POINTS, slopes={9: [1, 0, 0]}), "index of a slope is 9"),
        (lambda: rb.Curve(3), "Curve: 3 is no function"),
        (lambda: rb.Curve(lambda u: [u, u]), r"returns shape \(2,\); a point has three coordinates"),
        (lambda: rb.Curve(lambda u: [1, 2, 3]), "single point"),
        (lambda: rb.Curve(lambda u: [u, np.sqrt(u), 0], domain=(-1, 1)), "at parameter -1 is"),
        (lambda: rb.Curve(lambda u: [u, 0, 0], domain=(0, 1), closed=True), "ends where it began"),
        (lambda: rb.Curve(lambda u: [u, 0, 0], closed=True), "one round"),
    ],
)
def test_numbers_that_make_no_curve_are_refused_in_a_sentence(make, words):
    with pytest.raises(rb.InvalidInput, match=words):
        make()


def test_a_cusp_has_no_tangent():
    cusp = rb.Polynomial([[0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 0, 1]])
    with pytest.raises(rb.InvalidInput, match="cusp"):
        cusp.frenet(0.0)
