"""Functions of the user's that are called back: Python functions, and compiled ones by their address."""

import ctypes
import math
import threading
import weakref

import numpy as np
import pytest
import rbdyn as rb
from rbdyn._core import _user_function

ARGUMENTS = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)


def called_back(f):
    return _user_function("force", f, False)


@pytest.mark.parametrize(
    "f",
    [
        lambda t, r, v: t * r - v,
        lambda t, r, v: list(t * r - v),
        lambda t, r, v: tuple(float(x) for x in t * r - v),
        lambda t, r, v: (t * r - v).astype(object),
        lambda t, r, v: (t * r - v).astype(np.float32),
        lambda t, r, v: np.stack([t * r - v, r])[0, ::1],
        lambda t, x, y, z, vx, vy, vz: (t * x - vx, t * y - vy, t * z - vz),
        lambda *a: a[0] * a[1] - a[2],
    ],
)
def test_a_force_that_is_called_back_is_what_it_returns(f):
    assert called_back(f)(*ARGUMENTS) == (-3.5, -4.0, -4.5)
    assert called_back(f)(0.0, 0, 0, 0, 1, -1, 0) == (-1.0, 1.0, 0.0)


def test_whole_numbers_and_nan_are_passed_on():
    assert called_back(lambda t, r, v: (1, 2, True))(*ARGUMENTS) == (1.0, 2.0, 1.0)
    assert math.isnan(called_back(lambda t, r, v: (math.nan, 2, 3))(*ARGUMENTS)[0])


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        ((1.0, 2.0), r'function "f" returns shape \(2,\); a force has three components'),
        ([[1.0, 2.0, 3.0]], r"shape \(1, 3\)"),
        (1.0, "returns 1.0; a force"),
        (None, "None"),
        ("abc", "'abc'"),
        ((1.0, "a", 2.0), "'a'"),
        ((1.0, 2.0, 1j), "1j"),
    ],
)
def test_what_is_no_force_is_refused(returned, message):
    def f(t, r, v):
        return returned

    with pytest.raises(rb.InvalidInput, match=message) as caught:
        called_back(f)(*ARGUMENTS)
    assert str(caught.value).startswith("Force: ")


def test_an_exception_arrives_as_it_was_raised():
    class Mine(Exception):
        pass

    error = Mine("here")

    def f(t, r, v):
        raise error

    with pytest.raises(Mine) as caught:
        called_back(f)(*ARGUMENTS)
    assert caught.value is error


@pytest.mark.parametrize("options", [{"rtol": 1e-6}, {}], ids=str)
def test_an_exception_during_a_run_has_the_frames_of_the_function(options):
    scene = rb.Scene()
    ball = scene.add(rb.Particle(1.0), position=[1, 0, 0])

    def pull(t, r, v):
        if t > 0.5:
            raise RuntimeError("mine")
        return [-math.sin(r[0]), 0, 0]

    scene.apply(rb.Force(pull), ball)
    with pytest.raises(RuntimeError) as caught:
        rb.simulate(scene, 3.0, **options)
    assert caught.traceback[-1].name == "pull" and caught.value.run.status == "stopped by user"


def test_what_a_function_keeps_of_its_arguments_does_not_change():
    kept, parts = [], []

    def f(t, r, v):
        kept.append(r)
        parts.append(v[1:])
        return r

    user = called_back(f)
    for k in range(5):
        user(0.0, k, 0, 0, 0, k, 0)
    assert [r[0] for r in kept] == [v[0] for v in parts] == [0, 1, 2, 3, 4]


def test_a_function_that_calls_itself_has_arguments_of_its_own():
    def f(t, r, v):
        if t > 0:
            below = user(t - 1, *(2 * r), *v)
            return r + below
        return r

    user = called_back(f)
    assert user(2.0, 1, 0, 0, 0, 0, 0) == (7.0, 0.0, 0.0)


def test_any_thread_may_call_back_and_drop_the_function():
    results = []
    user = called_back(lambda t, r, v: t * r)

    def work(user):
        for k in range(200):
            results.append(user(k, 1, 2, 3, 0, 0, 0) == (k, 2 * k, 3 * k))

    threads = [threading.Thread(target=work, args=(user,)) for _ in range(4)]
    for thread in threads:
        thread.start()
    del user
    for thread in threads:
        thread.join()
    assert len(results) == 800 and all(results)


def test_a_function_lives_as_long_as_what_calls_it():
    class Force:
        __name__ = "Force"

        def __call__(self, t, r, v):
            return r

    f = Force()
    alive = weakref.ref(f)
    user = called_back(f)
    del f
    assert alive() is not None and user(*ARGUMENTS) == (1.0, 2.0, 3.0)
    del user
    assert alive() is None


# --- compiled functions ---

DOUBLES = ctypes.POINTER(ctypes.c_double)
FORCE = ctypes.CFUNCTYPE(None, ctypes.c_double, DOUBLES, DOUBLES, DOUBLES)


def test_a_pointer_of_ctypes_is_called_directly():
    @FORCE
    def f(t, r, v, force):
        for i in range(3):
            force[i] = t * r[i] - v[i]

    user = _user_function("force", f)
    assert (user.recorded, user.is_python, user.reason) == (None, False, "it is compiled")
    assert user(*ARGUMENTS) == (-3.5, -4.0, -4.5)
    with pytest.raises(rb.InvalidInput, match="compiled, and cannot be recorded"):
        _user_function("force", f, True)


def test_the_c_library_s_sine_drives():
    library = ctypes.CDLL("libm.so.6")
    with pytest.raises(rb.InvalidInput, match="set its argtypes"):
        _user_function("time", library.sin)
    library.sin.argtypes, library.sin.restype = [ctypes.c_double], ctypes.c_double
    assert _user_function("time", library.sin)(0.5) == math.sin(0.5)


def test_a_pointer_of_another_kind_is_refused():
    f = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(lambda t: t)
    with pytest.raises(
        rb.InvalidInput,
        match=r"compiled function is double\(double\); here it is void\(double,double\*,double\*,double\*\)",
    ):
        _user_function("force", f)
    g = ctypes.CFUNCTYPE(ctypes.c_float, ctypes.c_double)(lambda t: t)
    with pytest.raises(rb.InvalidInput, match=r"c_float\(double\); here it is double\(double\)"):
        _user_function("time", g)


def test_potentials_and_curves_may_be_compiled():
    potential = ctypes.CFUNCTYPE(ctypes.c_double, DOUBLES)(lambda r: r[0] + 10 * r[1] + 100 * r[2])
    assert _user_function("potential", potential)(1.0, 2.0, 3.0) == 321.0

    @ctypes.CFUNCTYPE(None, ctypes.c_double, DOUBLES)
    def curve(u, r):
        r[0], r[1], r[2] = u, 2 * u, 3 * u

    assert _user_function("curve", curve)(2.0) == (2.0, 4.0, 6.0)
    with pytest.raises(rb.InvalidInput, match="takes no compiled function"):
        _user_function("motion", curve)


def test_a_cfunc_of_numba_is_called_by_its_address():
    numba = pytest.importorskip("numba")
    doubles = numba.types.CPointer(numba.float64)

    @numba.cfunc(numba.void(numba.float64, doubles, doubles, doubles))
    def f(t, r, v, force):
        for i in range(3):
            force[i] = t * r[i] - v[i]

    user = _user_function("force", f)
    assert (user.recorded, user.is_python, user.name) == (None, False, "f")
    assert user(*ARGUMENTS) == (-3.5, -4.0, -4.5)
    with pytest.raises(rb.InvalidInput, match=r"here it is double\(double\)"):
        _user_function("time", f)
    sine = numba.cfunc("float64(float64)")(lambda t: math.sin(t))
    assert _user_function("time", sine)(0.5) == math.sin(0.5)


def test_what_numba_compiles_on_demand_is_recorded_from_its_source():
    numba = pytest.importorskip("numba")

    @numba.njit
    def f(t, x, y, z, vx, vy, vz):
        return -t * x, -y, np.sqrt(z)

    assert _user_function("force", f).recorded is not None
    assert _user_function("force", f)(*ARGUMENTS) == _user_function("force", f, False)(*ARGUMENTS)


def test_a_low_level_callable_of_scipy_is_called_by_its_address():
    scipy = pytest.importorskip("scipy")

    @FORCE
    def f(t, r, v, force):
        for i in range(3):
            force[i] = t * r[i] - v[i]

    assert _user_function("force", scipy.LowLevelCallable(f))(*ARGUMENTS) == (-3.5, -4.0, -4.5)
    with pytest.raises(rb.InvalidInput, match=r"here it is double\(double\)"):
        _user_function("time", scipy.LowLevelCallable(f))


def test_a_low_level_callable_brings_data_of_its_own():
    scipy = pytest.importorskip("scipy")
    stiffness = ctypes.c_double(3.0)
    kind = ctypes.CFUNCTYPE(None, ctypes.c_double, DOUBLES, DOUBLES, DOUBLES, ctypes.c_void_p)

    @kind
    def f(t, r, v, force, data):
        k = ctypes.cast(data, DOUBLES)[0]
        for i in range(3):
            force[i] = -k * r[i]

    user = _user_function("force", scipy.LowLevelCallable(f, ctypes.cast(ctypes.pointer(stiffness), ctypes.c_void_p)))
    assert user(*ARGUMENTS) == (-3.0, -6.0, -9.0)
    stiffness.value = 5.0
    assert user(*ARGUMENTS) == (-5.0, -10.0, -15.0)


def test_neither_numba_nor_scipy_is_imported(tmp_path):
    import subprocess
    import sys

    program = "import sys, rbdyn; rbdyn.Function(lambda t: t + 1); assert not {'numba', 'scipy'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", program], check=True, cwd=tmp_path)
