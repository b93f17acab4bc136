"""Quantities with a unit are refused where a number is asked for: NumPy would drop the unit."""

import numpy as np
import pytest
import rbdyn as rb


class Quantity:
    """What pint's quantities are to others: a magnitude and units, and an array of the magnitude for NumPy."""

    def __init__(self, magnitude, units="metre"):
        self.magnitude, self.units = magnitude, units

    units = magnitude = None

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.magnitude, dtype)

    def __float__(self):
        raise TypeError("it has a dimension")

    def __repr__(self):
        return f"{self.magnitude} {self.units}"


def scene_with_ball():
    scene = rb.Scene()
    return scene, scene.add(rb.Particle(1.0), velocity=[1, 0, 0], name="ball")


@pytest.fixture(params=["like pint's", "pint"])
def make(request):
    if request.param == "pint":
        registry = pytest.importorskip("pint").UnitRegistry()
        return lambda magnitude, unit="metre": registry.Quantity(magnitude, unit)
    return Quantity


def test_a_quantity_is_refused_in_a_sentence_wherever_numbers_are_taken(make):
    scene, ball = scene_with_ball()
    run = rb.simulate(scene, 1.0)
    calls = {
        "mass": lambda: rb.Particle(make(2.0, "kilogram")),
        "gravity": lambda: rb.Scene(gravity=make(np.array([0, 0, -9.81]))),
        "position": lambda: scene.add(rb.Particle(1.0), position=[make(1.0), make(0.0), make(0.0)]),
        "angle": lambda: scene.add(rb.shapes.sphere(1, 1), rb.Revolute([0, 0, 1]), angle=make(30.0, "degree")),
        "until": lambda: rb.simulate(scene, make(3.0, "second")),
        "radius": lambda: rb.Circle(radius=make(0.5), start=[1, 0, 0], toward=[0, 1, 0]),
        "time": lambda: run[ball].position(make(0.5, "second")),
        "velocity": lambda: rb.simulate(scene, 1.0, initial={(ball, "velocity"): make([1.0, 0, 0])}),
        "f": lambda: scene.apply(rb.Force(make(np.array([1.0, 0, 0]), "newton")), ball),
        "size": lambda: rb.shapes.box(1.0, [make(1.0), make(1.0), make(1.0)]),
    }
    for name, call in calls.items():
        with pytest.raises((rb.InvalidInput, TypeError), match=r"it has a unit, and numbers here are plain") as refused:
            call()
        if name != "f":
            assert f"{name} is" in str(refused.value)


def test_what_only_looks_like_a_quantity_is_taken():
    xarray = pytest.importorskip("xarray")
    named = xarray.DataArray([0.0, 0.5], attrs={"units": "s", "magnitude": 3})
    scene, ball = scene_with_ball()
    assert rb.simulate(scene, 1.0)[ball].position(named).shape == (2, 3)
    assert rb.Particle(np.float32(2)).mass == 2.0


def test_degrees_are_never_guessed():
    # an angle is in radians, and a string is none
    with pytest.raises(rb.InvalidInput, match="angle is '30deg'; give numbers"):
        rb.Scene().add(rb.shapes.sphere(1, 1), rb.Revolute([0, 0, 1]), angle="30deg")
    door = rb.Scene().add(rb.shapes.sphere(1, 1), rb.Revolute([0, 0, 1]), angle=90.0)
    assert door is not None
