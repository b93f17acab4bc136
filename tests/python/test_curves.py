"""Curves as Python sees them: geometry for a number, for an array, and rules for what makes a curve."""

import numpy as np
import pytest
import rbdyn as rb

CIRCLE = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0], center=[1, 2, 3])
HELIX = rb.Helix(radius=3.0, pitch=8 * np.pi, start=[1, 0, 0], toward=[0, 1, 0])
PARABOLA = rb.Polynomial([[0, 0, 0], [1, 0, 0], [0, 0, 1]], domain=(-2, 2))
LINE = rb.Line(direction=[3, 0, 4], point=[0, 1, 0])
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


@pytest.mark.parametrize("curve", [CIRCLE, HELIX, PARABOLA, LINE], ids=repr)
def test_a_curve_gives_a_vector_for_a_number_and_rows_for_an_array(curve):
    assert curve.position(0.3).shape == (3,)
    assert curve.position([0.1, 0.2]).shape == (2, 3)
    assert curve.position(np.zeros((4, 5))).shape == (4, 5, 3)
    assert isinstance(curve.curvature(0.3), float)
    assert curve.torsion([0.1, 0.2]).shape == (2,)
    assert isinstance(curve.length(0, 1), float)


@pytest.mark.parametrize("curve", [CIRCLE, HELIX, PARABOLA, LINE], ids=repr)
def test_the_frame_of_a_curve_is_orthonormal_and_right_handed(curve):
    frame = curve.frenet(np.linspace(-1, 1, 9))
    tangent, normal, binormal = frame
    assert frame.tangent.shape == (9, 3)
    np.testing.assert_allclose(np.cross(tangent, normal), binormal, atol=EXACT)
    np.testing.assert_allclose(np.sum(normal**2, axis=1), 1.0, rtol=EXACT)
    assert curve.frenet(0.0).normal.shape == (3,)


def test_lines_go_on_for_ever_and_a_polynomial_ends_where_it_is_told():
    assert LINE.domain == (-np.inf, np.inf)
    assert PARABOLA.domain == (-2.0, 2.0)
    assert CIRCLE.closed and not HELIX.closed


def test_curves_of_the_same_numbers_are_equal():
    assert rb.Line([1, 0, 0]) == rb.Line([1, 0, 0])
    assert hash(rb.Line([1, 0, 0])) == hash(rb.Line([1, 0, 0]))
    assert rb.Line([1, 0, 0]) != rb.Line([0, 1, 0])
    assert rb.Line([1, 0, 0]) != 3


def test_the_numbers_a_curve_was_made_from_can_be_read():
    assert CIRCLE.radius == 0.5 and HELIX.pitch == 8 * np.pi
    np.testing.assert_array_equal(CIRCLE.center, [1, 2, 3])
    np.testing.assert_array_equal(PARABOLA.coefficients, [[0, 0, 0], [1, 0, 0], [0, 0, 1]])
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
    ],
)
def test_numbers_that_make_no_curve_are_refused_in_a_sentence(make, words):
    with pytest.raises(rb.InvalidInput, match=words):
        make()


def test_a_cusp_has_no_tangent():
    cusp = rb.Polynomial([[0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 0, 1]])
    with pytest.raises(rb.InvalidInput, match="cusp"):
        cusp.frenet(0.0)
