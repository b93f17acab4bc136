"""
Dynamics of points and rigid bodies.
"""
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import os
import rbdyn.frames
import rbdyn.sample
import typing
__all__: list[str] = ['Ball', 'BodyHandle', 'BodyMotion', 'BodyNow', 'BodyPoint', 'BodyPointMotion', 'BodyShape', 'Central', 'Circle', 'Condition', 'ConstraintHandle', 'ConstraintMotion', 'ContactHandle', 'ContactMotion', 'CostRow', 'Coulomb', 'CouplingHandle', 'CouplingMotion', 'CouplingNow', 'Curve', 'Cycloid', 'Cylindrical', 'Drag', 'EffectRow', 'EffectTable', 'Equilibrium', 'EulerAngles', 'EulerTop', 'Event', 'Events', 'Expression', 'Fixed', 'Force', 'Free', 'Function', 'Gravitation', 'Handle', 'Helix', 'Hinge', 'JointForce', 'JointTorque', 'Line', 'LoadHandle', 'Lorentz', 'MissingEngine', 'NormalModes', 'Now', 'Omission', 'PairForce', 'Parabola', 'Parameter', 'Particle', 'Plan', 'Planar', 'Plane', 'PoinsotMotion', 'PointOnCurve', 'PointOnPlane', 'Polynomial', 'Potential', 'Prediction', 'Price', 'Prismatic', 'Rail', 'RailPotential', 'Revolute', 'RigidBody', 'Rod', 'Scene', 'Size', 'Sphere', 'Spherical', 'Spline', 'Spring', 'StateRun', 'Statistics', 'System', 'SystemNow', 'SystemPlan', 'SystemRun', 'SystemVariable', 'Torque', 'TorsionSpring', 'Trajectory', 'TurningPoints', 'Universal', 'UserFunction', 'WatchHandle', 'Watched', 'Weld', 'box', 'cone', 'cost', 'cylinder', 'disc', 'effects', 'ellipsoid', 'engines', 'equilibria', 'normal_modes', 'parameter', 'plan', 'points', 'rail_potential', 'ring', 'rod', 'shell', 'simulate', 'solid', 'sphere']
class _HasAddress(typing.Protocol):
    @property
    def address(self) -> int: ...
# a mapping whose keys are all handles, all names, or some of both: Mapping takes keys of its very type alone
class _Starts(typing.Protocol):
    def keys(self) -> collections.abc.Iterable[tuple[BodyHandle | str, str]]: ...
    def __getitem__(self, key: typing.Any, /) -> typing.Any: ...
_Number: typing.TypeAlias = float | numpy.floating[typing.Any] | numpy.integer[typing.Any]
_Numbers: typing.TypeAlias = (
    numpy.typing.NDArray[typing.Any]
    | collections.abc.Sequence[float]
    | collections.abc.Sequence[collections.abc.Sequence[float]]
)
_Attitude: typing.TypeAlias = numpy.typing.ArrayLike | EulerAngles | typing.Any
_End: typing.TypeAlias = BodyHandle | BodyPoint | numpy.typing.ArrayLike
_Vector: typing.TypeAlias = numpy.typing.ArrayLike | collections.abc.Sequence[typing.Any]
_Function: typing.TypeAlias = collections.abc.Callable[..., typing.Any]
_Of1: typing.TypeAlias = collections.abc.Callable[[typing.Any], typing.Any]
_Of3: typing.TypeAlias = collections.abc.Callable[[typing.Any, typing.Any, typing.Any], typing.Any]
_Of7: typing.TypeAlias = collections.abc.Callable[
    [typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any], typing.Any
]
_Of5: typing.TypeAlias = collections.abc.Callable[
    [typing.Any, typing.Any, typing.Any, typing.Any, typing.Any], typing.Any
]
_Of13: typing.TypeAlias = collections.abc.Callable[
    [
        typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any,
        typing.Any, typing.Any, typing.Any, typing.Any, typing.Any, typing.Any
    ],
    typing.Any,
]
_Compiled: typing.TypeAlias = Function | _HasAddress | tuple[typing.Any, ...]
_Pole: typing.TypeAlias = numpy.typing.ArrayLike | _Of1 | Function | BodyHandle | BodyPoint
_Watched: typing.TypeAlias = collections.abc.Callable[[Now], typing.Any]
_WatchedState: typing.TypeAlias = collections.abc.Callable[[SystemNow], typing.Any]
_Of2: typing.TypeAlias = collections.abc.Callable[[typing.Any, typing.Any], typing.Any]
_Engine: typing.TypeAlias = typing.Literal['auto', 'closed form', 'taylor', 'dop853', 'cvode-adams', 'cvode-bdf']
class Condition:
    """
    A comparison of recorded numbers, or several joined by & | ~ ^.

    where(condition, a, b) and np.where choose by it. An `if` on it records both sides: the function is called again for
    the other one.
    """
    def __add__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __and__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __array_function__(self, *args: typing.Any, **kwargs: typing.Any) -> typing.Any:
        ...
    def __array_ufunc__(self, *args: typing.Any, **kwargs: typing.Any) -> typing.Any:
        ...
    def __bool__(self) -> bool:
        ...
    def __invert__(self) -> typing.Any:
        ...
    def __mul__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __or__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __radd__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rand__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __repr__(self) -> str:
        ...
    def __rmul__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __ror__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rsub__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rxor__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __sub__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __truediv__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __xor__(self, arg0: typing.Any) -> typing.Any:
        ...
    def logical_not(self) -> typing.Any:
        """
        Whether it does not hold.
        """
class Expression:
    """
    A number that is being recorded: what a function of the user's is called with instead of a float.

    Arithmetic and NumPy's functions are recorded. A comparison gives a Condition. Changes of formula (an `if`, np.where,
    abs, a length at zero, floor) become events that are located. Its value is not known: float(), == and the functions of
    math raise InvalidInput.
    """
    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __abs__(self) -> Expression:
        ...
    def __add__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __array_function__(self, *args: typing.Any, **kwargs: typing.Any) -> typing.Any:
        ...
    def __array_ufunc__(self, *args: typing.Any, **kwargs: typing.Any) -> typing.Any:
        ...
    def __bool__(self) -> bool:
        ...
    def __ceil__(self) -> Expression:
        ...
    def __divmod__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __eq__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __float__(self) -> float:
        ...
    def __floor__(self) -> Expression:
        ...
    def __floordiv__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __ge__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __gt__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __int__(self) -> int:
        ...
    def __le__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __lt__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __mod__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __mul__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __ne__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __neg__(self) -> Expression:
        ...
    def __pos__(self) -> Expression:
        ...
    def __pow__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __radd__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rdivmod__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __repr__(self) -> str:
        ...
    def __rfloordiv__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rmod__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rmul__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __round__(self, digits: typing.SupportsInt | typing.SupportsIndex = 0) -> Expression:
        ...
    def __rpow__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rsub__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rtruediv__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __sub__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __truediv__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __trunc__(self) -> Expression:
        ...
    def absolute(self) -> Expression:
        """
        numpy.absolute of it.
        """
    def arccos(self) -> Expression:
        """
        numpy.arccos of it.
        """
    def arccosh(self) -> Expression:
        """
        numpy.arccosh of it.
        """
    def arcsin(self) -> Expression:
        """
        numpy.arcsin of it.
        """
    def arcsinh(self) -> Expression:
        """
        numpy.arcsinh of it.
        """
    def arctan(self) -> Expression:
        """
        numpy.arctan of it.
        """
    def arctan2(self, arg0: typing.Any) -> typing.Any:
        """
        numpy.arctan2 of it and another.
        """
    def arctanh(self) -> Expression:
        """
        numpy.arctanh of it.
        """
    def cbrt(self) -> Expression:
        """
        numpy.cbrt of it.
        """
    def ceil(self) -> Expression:
        """
        numpy.ceil of it.
        """
    def conjugate(self) -> Expression:
        """
        numpy.conjugate of it.
        """
    def cos(self) -> Expression:
        """
        numpy.cos of it.
        """
    def cosh(self) -> Expression:
        """
        numpy.cosh of it.
        """
    def deg2rad(self) -> Expression:
        """
        numpy.deg2rad of it.
        """
    def degrees(self) -> Expression:
        """
        numpy.degrees of it.
        """
    def exp(self) -> Expression:
        """
        numpy.exp of it.
        """
    def exp2(self) -> Expression:
        """
        numpy.exp2 of it.
        """
    def expm1(self) -> Expression:
        """
        numpy.expm1 of it.
        """
    def fabs(self) -> Expression:
        """
        numpy.fabs of it.
        """
    def floor(self) -> Expression:
        """
        numpy.floor of it.
        """
    def fmod(self, arg0: typing.Any) -> typing.Any:
        """
        numpy.fmod of it and another.
        """
    def hypot(self, arg0: typing.Any) -> typing.Any:
        """
        numpy.hypot of it and another.
        """
    def log(self) -> Expression:
        """
        numpy.log of it.
        """
    def log10(self) -> Expression:
        """
        numpy.log10 of it.
        """
    def log1p(self) -> Expression:
        """
        numpy.log1p of it.
        """
    def log2(self) -> Expression:
        """
        numpy.log2 of it.
        """
    def negative(self) -> Expression:
        """
        numpy.negative of it.
        """
    def positive(self) -> Expression:
        """
        numpy.positive of it.
        """
    def rad2deg(self) -> Expression:
        """
        numpy.rad2deg of it.
        """
    def radians(self) -> Expression:
        """
        numpy.radians of it.
        """
    def reciprocal(self) -> Expression:
        """
        numpy.reciprocal of it.
        """
    def rint(self) -> Expression:
        """
        numpy.rint of it.
        """
    def sign(self) -> Expression:
        """
        numpy.sign of it.
        """
    def sin(self) -> Expression:
        """
        numpy.sin of it.
        """
    def sinh(self) -> Expression:
        """
        numpy.sinh of it.
        """
    def sqrt(self) -> Expression:
        """
        numpy.sqrt of it.
        """
    def square(self) -> Expression:
        """
        numpy.square of it.
        """
    def tan(self) -> Expression:
        """
        numpy.tan of it.
        """
    def tanh(self) -> Expression:
        """
        numpy.tanh of it.
        """
    def trunc(self) -> Expression:
        """
        numpy.trunc of it.
        """
class Parameter:
    """
    A number that functions use by reference.

        k = rb.parameter(2.0, "k")
        force = rb.Force(lambda t, position, velocity: -k * position)
        k.value = 3.0  # from here on, in runs that start later

    In a function it stands for its value in arithmetic and NumPy's functions; a function that is recorded is not recorded
    again when it changes. Elsewhere ask for .value.
    """
    def __abs__(self) -> typing.Any:
        ...
    def __add__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __array_function__(self, *args: typing.Any, **kwargs: typing.Any) -> typing.Any:
        ...
    def __array_ufunc__(self, *args: typing.Any, **kwargs: typing.Any) -> typing.Any:
        ...
    def __bool__(self) -> bool:
        ...
    def __ceil__(self) -> typing.Any:
        ...
    def __divmod__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __eq__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __float__(self) -> float:
        ...
    def __floor__(self) -> typing.Any:
        ...
    def __floordiv__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __ge__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __gt__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __hash__(self) -> int:
        ...
    def __le__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __lt__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __mod__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __mul__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __neg__(self) -> typing.Any:
        ...
    def __pos__(self) -> typing.Any:
        ...
    def __pow__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __radd__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rdivmod__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __reduce__(self) -> tuple[typing.Any, tuple[float, str]]:
        ...
    def __repr__(self) -> str:
        ...
    def __rfloordiv__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rmod__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rmul__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __round__(self, ndigits: typing.Any = None) -> typing.Any:
        ...
    def __rpow__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rsub__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __rtruediv__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __sub__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __truediv__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __trunc__(self) -> typing.Any:
        ...
    @property
    def name(self) -> str:
        """
        As it was given; empty if it was not.
        """
    @property
    def value(self) -> typing.Any:
        """
        Its number; finite. Inside a function that is being recorded, the parameter itself.
        """
    @value.setter
    def value(self, arg1: typing.Any) -> None:
        ...
class Function:
    """
    A recorded function: numbers in, numbers out, kept as a list of operations.

        f = rb.Function(lambda x, y: np.hypot(x, y))
        f(3.0, 4.0)  # 5.0

    Recorded by calling f once, or once for each side of an `if`. Data: it can be printed, compared, copied and pickled, and
    given wherever a function with its inputs is taken. Raises InvalidInput if f cannot be recorded.
    """
    def __call__(self, *args: typing.Any) -> typing.Any:
        """
        One number for one result, a tuple for several.

        Inside a function that is being recorded it becomes part of that one.
        """
    def __eq__(self, arg0: typing.Any) -> typing.Any:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, f: typing.Any, inputs: typing.SupportsInt | typing.SupportsIndex | None = None) -> None:
        """
        f: of `inputs` numbers, by default as many as it has parameters, a million at most; returns a number, or an array of them.
        """
    def __reduce__(self) -> tuple[typing.Any, tuple[typing.Any, ...]]:
        ...
    def __repr__(self) -> str:
        ...
    def __str__(self) -> str:
        ...
    @property
    def inputs(self) -> int:
        """
        How many numbers it takes.
        """
    @property
    def outputs(self) -> int:
        """
        How many numbers it gives.
        """
    @property
    def parameters(self) -> list[typing.Any]:
        """
        The parameters it uses by reference.
        """
class UserFunction:
    """
    How a function of the user's is run: recorded, or called back, and why.
    """
    def __call__(self, *args: typing.Any) -> typing.Any:
        """
        Its results for numbers.
        """
    def __repr__(self) -> str:
        ...
    @property
    def calls(self) -> int:
        """
        How often it was called back.
        """
    @property
    def is_python(self) -> bool:
        """
        Whether Python runs it.
        """
    @property
    def name(self) -> str:
        """
        Of the function.
        """
    @property
    def reason(self) -> str:
        """
        Why it is called back; empty if it is not.
        """
    @property
    def recorded(self) -> Function | None:
        """
        The recorded function; None if it is called back.
        """
class Curve:
    """
    A curve r(u) in the world, of any function: Curve(lambda u: [u, np.sin(u), 0.2 * u**2], domain=(0, 3)).

    Base of Line, Circle, Parabola, Cycloid, Helix, Polynomial and Spline. A parameter u is a number, or an array of any
    shape: a vector then comes back with its components last.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, function: _Of1 | Function, domain: tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex] | None = None, closed: bool = False) -> None:
        """
        function: of u, gives the three components of r(u) [m], in plain Python and NumPy; it is called once and
        recorded, with its derivatives. domain: first and last parameter; without it the curve has no ends. closed: it ends
        where it began, in r and r', and its parameter counts on; domain is one round.
        """
    def __reduce__(self) -> tuple[typing.Any, ...]:
        ...
    def __repr__(self) -> str:
        ...
    @typing.overload
    def curvature(self, u: _Numbers) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def curvature(self, u: _Number) -> float:
        """
        1/rho of eq. 7.10 [1/m]; 0 where straight. Raises InvalidInput at a cusp.
        """
    def frenet(self, u: numpy.typing.ArrayLike) -> rbdyn.frames.Frenet:
        """
        Tangent, normal and binormal (eqs. 7.9, 7.10): a named tuple of unit vectors, each (3,) or (n, 3).

        On a straight stretch the frame of least rotation. Raises InvalidInput at a cusp.
        """
    @typing.overload
    def length(self, u0: _Numbers, u1: _Numbers) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def length(self, u0: _Number, u1: _Number) -> float:
        """
        Arc length from u0 to u1, negative if u1 < u0 [m]. Arrays are broadcast.
        """
    def position(self, u: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        r(u), (3,) or (n, 3) [m].
        """
    @typing.overload
    def torsion(self, u: _Numbers) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def torsion(self, u: _Number) -> float:
        """
        Torsion [1/m], positive for a right-handed helix; 0 where straight.
        """
    @property
    def closed(self) -> bool:
        """
        Whether it comes back to where it started; its parameter counts on.
        """
    @property
    def domain(self) -> tuple[float, float]:
        """
        The first and the last parameter; infinite where the curve goes on.
        """
    @property
    def name(self) -> str:
        """
        What it is, in words.
        """
class Line(Curve):
    """
    A straight line by its length: r(u) = point + u direction/|direction|.
    """
    def __init__(self, direction: numpy.typing.ArrayLike, point: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        direction: of any length but zero. point: where u = 0 [m]. World axes; u in m.
        """
    def __repr__(self) -> str:
        ...
    @property
    def direction(self) -> typing.Any:
        """
        Of its tangent (3,), as given.
        """
    @property
    def point(self) -> typing.Any:
        """
        Where u = 0 (3,) [m].
        """
class Circle(Curve):
    """
    A circle by its angle: r(u) = center + radius (cos u start + sin u toward); the angle counts on.
    """
    def __init__(self, radius: typing.SupportsFloat | typing.SupportsIndex, start: numpy.typing.ArrayLike, toward: numpy.typing.ArrayLike, center: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        radius [m], positive. start, toward: directions from the center to u = 0 and to the side on which u grows, made
        orthonormal. center [m]. World axes; u in rad.
        """
    def __repr__(self) -> str:
        ...
    @property
    def center(self) -> typing.Any:
        """
        (3,) [m].
        """
    @property
    def radius(self) -> float:
        """
        [m]
        """
    @property
    def start(self) -> typing.Any:
        """
        Direction from the center to u = 0 (3,), as given.
        """
    @property
    def toward(self) -> typing.Any:
        """
        Direction to the side on which u grows (3,), as given.
        """
class Helix(Curve):
    """
    A circular helix by its angle: r(u) = center + radius (cos u start + sin u toward) + pitch/(2 pi) u axis.
    """
    def __init__(self, radius: typing.SupportsFloat | typing.SupportsIndex, pitch: typing.SupportsFloat | typing.SupportsIndex, start: numpy.typing.ArrayLike, toward: numpy.typing.ArrayLike, center: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        radius [m], positive. pitch [m] a turn, along start x toward; negative for a left-handed helix, not zero.
        start, toward: directions from the axis to u = 0 and to the side on which u grows, made orthonormal. center: point of
        the axis beside u = 0 [m]. World axes; u in rad.
        """
    def __repr__(self) -> str:
        ...
    @property
    def center(self) -> typing.Any:
        """
        (3,) [m].
        """
    @property
    def pitch(self) -> float:
        """
        [m] a turn.
        """
    @property
    def radius(self) -> float:
        """
        [m]
        """
    @property
    def start(self) -> typing.Any:
        """
        Direction from the center to u = 0 (3,), as given.
        """
    @property
    def toward(self) -> typing.Any:
        """
        Direction to the side on which u grows (3,), as given.
        """
class Polynomial(Curve):
    """
    A polynomial curve: r(u) = sum of c_k u^k.
    """
    def __init__(self, coefficients: numpy.typing.ArrayLike, *, domain: tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex] | None = None) -> None:
        """
        coefficients: (n, 3), vectors in the world in increasing powers of u [m]. domain: first and last parameter; without
        it the curve has no ends.
        """
    def __repr__(self) -> str:
        ...
    @property
    def coefficients(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        In increasing powers of u (n, 3) [m].
        """
class Parabola(Curve):
    """
    A parabola by the distance along its tangent at the vertex: r(u) = vertex + u x + a u^2 y.
    """
    def __init__(self, a: typing.SupportsFloat | typing.SupportsIndex, x: numpy.typing.ArrayLike, y: numpy.typing.ArrayLike, vertex: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        a [1/m], not zero. x: direction of the tangent at the vertex; y: side to which the parabola opens, if a is
        positive; made orthonormal. vertex [m]. World axes; u in m.
        """
    def __repr__(self) -> str:
        ...
    @property
    def a(self) -> float:
        """
        [1/m].
        """
    @property
    def vertex(self) -> typing.Any:
        """
        Where u = 0 (3,) [m].
        """
    @property
    def x(self) -> typing.Any:
        """
        Direction of the tangent at the vertex (3,), as given.
        """
    @property
    def y(self) -> typing.Any:
        """
        Direction across it (3,), as given.
        """
class Cycloid(Curve):
    """
    A cycloid by the angle of its rolling circle: r(u) = vertex + radius ((u + sin u) x + (1 - cos u) y).

    The tautochrone, if y is up. At its cusps, u = pi, 3 pi, ... and their opposites, it has no tangent.
    """
    def __init__(self, radius: typing.SupportsFloat | typing.SupportsIndex, x: numpy.typing.ArrayLike, y: numpy.typing.ArrayLike, vertex: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        radius of the rolling circle [m], positive. x: direction of the tangent at the vertex; y: side of the cusps;
        made orthonormal. vertex: where u = 0 [m]. World axes; u in rad.
        """
    def __repr__(self) -> str:
        ...
    @property
    def radius(self) -> float:
        """
        [m]
        """
    @property
    def vertex(self) -> typing.Any:
        """
        Where u = 0 (3,) [m].
        """
    @property
    def x(self) -> typing.Any:
        """
        Direction of the tangent at the vertex (3,), as given.
        """
    @property
    def y(self) -> typing.Any:
        """
        Direction across it (3,), as given.
        """
class Spline(Curve):
    """
    A cubic spline through points, r(k) = points[k]; C2, not-a-knot at its ends.

    Three points give a parabola, two a line. Where slopes gives r' at a point, that is what it is there, and r'' may jump:
    at an end, or where the curvature of a rail changes at once.
    """
    def __init__(self, points: numpy.typing.ArrayLike, closed: bool = False, *, slopes: collections.abc.Mapping[typing.SupportsInt | typing.SupportsIndex, numpy.typing.ArrayLike] = {}) -> None:
        """
        points: (n, 3), at u = 0 .. n-1 [m]; neighbours differ. closed: from the last point on to the first, which is
        not repeated; the parameter counts on, n a round. slopes: {index of a point: r' there} [m]. World axes.
        """
    def __repr__(self) -> str:
        ...
    @property
    def points(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        At u = 0 .. n-1 (n, 3) [m].
        """
    @property
    def slopes(self) -> dict[int, numpy.typing.NDArray[numpy.float64]]:
        """
        {index of a point: r' there} [m].
        """
class EulerAngles:
    """
    Nutation theta, precession psi, proper rotation phi [rad].

    R(body to world) = Rz(psi) Rx(theta) Rz(phi). Any size; (-theta, psi + pi, phi + pi) and whole turns of each are the
    same attitude. Where sin(theta) = 0 the rates fail and the motion does not. Arrays of angles, rates and second
    derivatives are in the order theta, psi, phi.
    """
    @staticmethod
    def of(attitude: _Attitude, *, previous: EulerAngles | None = None) -> EulerAngles:
        """
        The angles of an attitude: a quaternion (w, x, y, z), a matrix (3, 3), EulerAngles or a scipy Rotation.

        theta in [0, pi], psi and phi in [-pi, pi], phi = 0 where theta is exactly 0 or pi; or with previous angles, those of
        the same attitude that are nearest to them: continuous along a motion sampled so closely that no angle changes by a
        quarter turn, through theta = 0 and pi too, where theta goes on and psi keeps its value. Raises InvalidInput for what
        is no rotation to within 1e-6.
        """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[float, float, float]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, theta: typing.SupportsFloat | typing.SupportsIndex, psi: typing.SupportsFloat | typing.SupportsIndex, phi: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        theta, psi, phi [rad].
        """
    def __iter__(self) -> collections.abc.Iterator[typing.Any]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def angular_acceleration(self, rates: numpy.typing.ArrayLike, second: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        omega' in body axes [rad/s^2] from the rates and theta'', psi'', phi'' (eq. 7.50).
        """
    def angular_velocity(self, rates: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        omega in body axes [rad/s] from theta', psi', phi' (eq. 7.49).
        """
    def rates(self, angular_velocity: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        theta', psi', phi' [rad/s] from omega in body axes (eq. 7.49).

        Where theta is 0 or pi: psi' = 0, or psi' and phi' infinite if omega is not in the plane of e_3 and the axis of
        nutation.
        """
    def right_side(self, rates: numpy.typing.ArrayLike, moments: numpy.typing.ArrayLike, torque: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        b of eq. 7.52 [rad/s^2], its sign corrected: A (theta'', psi'', phi'') = b.

        moments: principal, about a fixed point or the centre of mass [kg m^2]. torque: about the same, body axes [N m].
        """
    @property
    def matrix(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        A of eq. 7.51, (3, 3): omega in body axes = A (theta', psi', phi'); det A = sin(theta).
        """
    @property
    def phi(self) -> float:
        """
        Proper rotation [rad].
        """
    @property
    def psi(self) -> float:
        """
        Precession [rad].
        """
    @property
    def quaternion(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (w, x, y, z), unit. Raises InvalidInput unless the angles are finite.
        """
    @property
    def rotation_matrix(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        R, (3, 3): its columns are the body's axes in the world. Raises InvalidInput unless the angles are finite.
        """
    @property
    def theta(self) -> float:
        """
        Nutation [rad].
        """
class RigidBody:
    """
    A rigid body: mass, centre of mass and inertia, in axes fixed in it.

    Bodies in the same axes are added where they are welded: a + b. What derives from the numbers given is computed in 32
    digits.
    """
    def __add__(self, arg0: RigidBody) -> RigidBody:
        ...
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, mass: typing.SupportsFloat | typing.SupportsIndex, inertia: numpy.typing.ArrayLike, *, com: numpy.typing.ArrayLike = (0, 0, 0), inertia_about: typing.Literal['com', 'origin'] = 'com') -> None:
        """
        mass: [kg], positive.

        inertia: three principal moments along the body's axes, or the symmetric matrix (3, 3) with elements -Int rho x_i x_j
        off its diagonal (eq. 7.33) [kg m^2].

        com: the centre of mass in the body's axes [m]. inertia_about: "com", or "origin" of the body's axes.

        Raises InvalidInput if no distribution of mass has these properties: a moment below zero, or above the sum of the other
        two. Discs, laminae and rods are bodies.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def gyroscope_axis(self, rtol: typing.SupportsFloat | typing.SupportsIndex = 1e-09) -> numpy.typing.NDArray[numpy.float64] | None:
        """
        The gyroscopic axis e_3, a unit vector in body axes, or None; the third axis if all moments are equal.
        """
    def imbalance(self, axis: numpy.typing.ArrayLike, point: numpy.typing.ArrayLike = (0.0, 0.0, 0.0)) -> rbdyn.frames.Imbalance:
        """
        What the body asks of the bearings of an axis, by its motion alone: a named tuple (7.47).

        axis: a direction (3,) through a point (3,) [m], fixed in the body, body axes. offset (3,) [kg m]: mass times the way
        from the axis to the centre of mass, across it. couple (3,) [kg m^2]: e x I e, with I about the point. Turning at a rate
        w the bearings exert the force -w^2 offset and about the point the moment w^2 couple, body axes.
        """
    def inertia(self, about: typing.Literal['com', 'origin'] | numpy.typing.ArrayLike = 'com') -> numpy.typing.NDArray[numpy.float64]:
        """
        The matrix of inertia about "com", "origin" or a point (3,) [m]; body axes, (3, 3) [kg m^2].

        Huygens-Steiner; elements -Int rho x_i x_j off the diagonal (eq. 7.33).
        """
    def is_balanced(self, axis: numpy.typing.ArrayLike, point: numpy.typing.ArrayLike = (0.0, 0.0, 0.0), rtol: typing.SupportsFloat | typing.SupportsIndex = 1e-09) -> bool:
        """
        Whether it turns about an axis without load on its bearings: a principal axis about the centre of mass.

        axis: a direction (3,) through a point (3,) [m], body axes. rtol: of the moments about the point, and of mass times
        radius of gyration.
        """
    def is_gyroscope(self, rtol: typing.SupportsFloat | typing.SupportsIndex = 1e-09) -> bool:
        """
        Whether two principal moments about the centre of mass differ by at most rtol, relative (Def. 7.4).
        """
    def principal(self, about: typing.Literal['com', 'origin'] | numpy.typing.ArrayLike = 'com') -> rbdyn.frames.PrincipalAxes:
        """
        Principal moments (3,) [kg m^2] and axes about "com", "origin" or a point [m]: a named tuple.

        The columns of axes (3, 3) are unit vectors in body axes, right-handed, each the one nearest to its body axis.
        """
    def rotated(self, attitude: _Attitude) -> RigidBody:
        """
        Turned about the origin of its axes: what lay along v lies along R v.

        attitude: a quaternion (w, x, y, z), a matrix (3, 3), EulerAngles or a scipy Rotation.
        """
    def shifted(self, r: numpy.typing.ArrayLike) -> RigidBody:
        """
        Moved by r in its own axes [m]: what was at the origin is at r.
        """
    @property
    def com(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Centre of mass from the body's origin, body axes, (3,) [m].
        """
    @property
    def inertia_about(self) -> str:
        """
        What the inertia was given about: "com" or "origin".
        """
    @property
    def is_rod(self) -> bool:
        """
        Whether all mass lies on a line: nothing resists a spin about it.
        """
    @property
    def mass(self) -> float:
        """
        [kg]
        """
class PoinsotMotion:
    """
    The motion of a rigid body without torque (Def. 7.2, 7.53-7.56).

    About the centre of mass of a free body, or about a point of it that is held where no moment acts. Body axes; the
    world's are those of the body at the start.
    """
    def __getstate__(self) -> tuple[RigidBody, tuple[typing.Any, ...], typing.Any]:
        ...
    def __init__(self, body: RigidBody, angular_velocity: numpy.typing.ArrayLike, *, point: numpy.typing.ArrayLike | None = None) -> None:
        """
        angular_velocity (3,) [rad/s], body axes; point (3,) [m], body axes: the centre of mass by default.

        Raises InvalidInput for a body without three moments of inertia there.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def herpolhode(self, count: typing.SupportsInt | typing.SupportsIndex = 200, until: typing.SupportsFloat | typing.SupportsIndex | None = None) -> numpy.typing.NDArray[numpy.float64]:
        """
        The way of omega in the world (count, 3) [rad/s], up to a time [s]; times as of polhode().
        """
    def polhode(self, count: typing.SupportsInt | typing.SupportsIndex = 200, until: typing.SupportsFloat | typing.SupportsIndex | None = None) -> numpy.typing.NDArray[numpy.float64]:
        """
        The way of omega in the body (count, 3) [rad/s], up to a time [s], by default one period.

        Raises InvalidInput for a time in which |omega| makes more than 2^64 rad: its digits do not tell where omega is then.
        """
    @property
    def angular_momentum(self) -> typing.Any:
        """
        K (3,) [kg m^2/s], body axes.
        """
    @property
    def growth_rate(self) -> float:
        """
        The rate at which a small disturbance of a permanent rotation grows [1/s].

        Zero about a stable axis; nan for a rotation that is not permanent.
        """
    @property
    def is_permanent(self) -> bool:
        """
        Whether the angular velocity stays as it is (Thm 7.12), within the rounding of axes that were computed:
        |I omega x omega| at most 1e-12 of |I omega| |omega|.
        """
    @property
    def kind(self) -> str:
        """
        rest, permanent, symmetric (a regular precession), separatrix or generic.
        """
    @property
    def kinetic_energy(self) -> float:
        """
        [J]
        """
    @property
    def period(self) -> float:
        """
        Of the angular velocity in body axes [s]; infinite where it has none.
        """
    @property
    def plane_distance(self) -> float:
        """
        omega.K/|K|: where Poinsot's plane lies [rad/s] (Prop. 7.1).
        """
    @property
    def precession_rate(self) -> float:
        """
        Mean rate at which the axis that K circles goes round K [rad/s] (Prop. 7.3).
        """
    @property
    def proper_rotation_rate(self) -> float:
        """
        Mean rate at which the body turns about that axis [rad/s].
        """
    @property
    def tilt(self) -> tuple[float, float]:
        """
        Least and largest angle between that axis and K [rad].
        """
class Coulomb:
    """
    Coulomb-Morin friction (eq. 7.23).

    Sliding, the tangential reaction is mu_dynamic times the perpendicular one, against the slip; at rest it is whatever
    rest needs, up to mu_static times the perpendicular one. In a joint the perpendicular one is what of the whole reaction
    lies across its axis.

    At contacts torques resist what does not slip: against rolling, the relative angular velocity along the surface, rolling
    [m] times the normal force, and against pivoting, the one along its normal, pivoting [m] times it; at rest each is
    whatever rest needs, up to that.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, mu_static: float | Parameter, mu_dynamic: float | Parameter | None = None, rolling: float | Parameter = 0.0, pivoting: float | Parameter = 0.0) -> None:
        """
        mu_static: zero or positive. mu_dynamic: at most mu_static, and equal to it by default. rolling, pivoting: lengths [m], zero or positive, of contacts alone.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def mu_dynamic(self) -> float | Parameter:
        """
        Sliding.
        """
    @property
    def mu_static(self) -> float | Parameter:
        """
        At rest.
        """
    @property
    def pivoting(self) -> float | Parameter:
        """
        Torque against pivoting over N [m].
        """
    @property
    def rolling(self) -> float | Parameter:
        """
        Torque against rolling over N [m].
        """
class Rail:
    """
    A guide along a curve, smooth or rough (eqs. 7.7-7.17, 7.23-7.26).

    A body on it starts with parameter or arc_length [m], and speed = ds/dt along the curve as placed [m/s]. Slip, and with
    it reverse, stick and slip events, is speed - drive.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, Coulomb | None, typing.Any, typing.Any, str, str, numpy.typing.NDArray[numpy.float64] | None]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, curve: Curve, *, friction: Coulomb | None = None, drive: float | Parameter | _Of1 | Function = 0.0, motion: _Of1 | Function | None = None, side: typing.Literal['both', '+', '-'] = 'both', ends: typing.Literal['stop', 'release'] = 'stop', up: numpy.typing.ArrayLike | None = None) -> None:
        """
        friction: Coulomb, or none.

        drive: the speed with which the rail's surface slides along itself [m/s], a number or a function of time [s]; the curve
        stays.

        motion: a rigid motion of the rail itself, a function of time that returns a displacement (3,) [m], a rotation matrix
        (3, 3), a pair of them, or a homogeneous matrix (4, 4); the curve is where it was given for no displacement and no
        rotation. The reaction then has power, also without friction (Theorem 7.7 needs a rail at rest).

        side: "both", or "+" or "-" for a rail that only pushes, along the curve's normal or against it: the normal on the side
        of up where the body starts, or else that of Frenet's axes there (of a straight rail the one nearest to world z, or to
        world x if it is vertical), carried on continuously; push_direction(parameter) shows it. Pulled away, the body leaves
        ("detach") and flies; where it meets the curve again from that side it lands ("land") and keeps its velocity along the
        curve. For plane curves at rest.

        ends: "stop", the run ends where the body reaches an end of the curve, or "release", it goes on freely.

        up: a direction (3,), world axes, on the "+" side of the curve where the body starts; of a straight rail, the part of up
        across it is the direction in which side "+" pushes.

        Functions are recorded: called before anything runs, with expressions. Raises InvalidInput if they cannot be.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @typing.overload
    def drive(self, t: _Numbers) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def drive(self, t: _Number) -> float:
        """
        The speed of the rail's surface along itself at a time [m/s].
        """
    def push_direction(self, parameter: typing.SupportsFloat | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float64] | None:
        """
        The way the rail pushes a body that starts at a parameter: a unit vector (3,), world axes.

        None if it holds on both sides. Raises InvalidInput if its curve is not plane, or up says no side there.
        """
    @property
    def curve(self) -> Curve:
        """
        What it follows.
        """
    @property
    def ends(self) -> str:
        """
        "stop" or "release".
        """
    @property
    def friction(self) -> Coulomb | None:
        """
        Friction, if any of its coefficients is not zero.
        """
    @property
    def moves(self) -> bool:
        """
        Whether the rail itself moves.
        """
    @property
    def side(self) -> str:
        """
        "both", "+" or "-".
        """
    @property
    def up(self) -> numpy.typing.NDArray[numpy.float64] | None:
        """
        A direction on the "+" side where the body starts, (3,) world axes; None if none was given.
        """
class Particle:
    """
    A material point.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[float | Parameter]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, mass: float | Parameter) -> None:
        """
        mass [kg], positive and finite; a number, or rb.parameter.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def mass(self) -> float | Parameter:
        """
        [kg]
        """
class Free:
    """
    No constraint.

    A particle then starts with position [m] and velocity [m/s], world axes; a rigid body with those of the origin of its
    axes, attitude, and angular_velocity (body axes) or angular_velocity_world [rad/s].
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self) -> None:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
class Spherical:
    """
    A ball joint: one point of a rigid body is held, and it turns as it likes (7.57).

    The body starts with attitude, and angular_velocity (body axes) or angular_velocity_world [rad/s].
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...], tuple[typing.Any, ...]]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, *, at: numpy.typing.ArrayLike = [0.0, 0.0, 0.0], point: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        at (3,): where in the world; point (3,): which point of the body, body axes [m].
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def at(self) -> typing.Any:
        """
        In the world (3,) [m].
        """
    @property
    def point(self) -> typing.Any:
        """
        In body axes (3,) [m].
        """
class Revolute:
    """
    A hinge: a rigid body turns about a fixed axis (7.60).

    The body starts with angle [rad] and rate [rad/s], right-handed about the axis. At angle 0 body axes and world axes
    coincide, so that the axis is the same direction in both.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...], tuple[typing.Any, ...], tuple[typing.Any, ...], typing.Any, typing.Any, typing.Any]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, axis: numpy.typing.ArrayLike, *, at: numpy.typing.ArrayLike = [0.0, 0.0, 0.0], point: numpy.typing.ArrayLike = [0.0, 0.0, 0.0], motion: _Of1 | Function | None = None, friction: Coulomb | None = None, pin_radius: float | Parameter = 0.0) -> None:
        """
        axis (3,): a direction, of any length; at (3,): where it passes, both in the parent's axes (the world's by
        default); point (3,): which point of the body is held there, body axes [m]; motion: the angle [rad] as a function of time
        [s], if it is prescribed: then the start has none; friction: Coulomb(...), a torque about the axis of up to mu times
        pin_radius [m] times what of the whole reaction force lies across the axis.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def at(self) -> typing.Any:
        """
        In the parent's axes (3,) [m].
        """
    @property
    def axis(self) -> typing.Any:
        """
        Its direction as given (3,), the parent's axes.
        """
    @property
    def driven(self) -> bool:
        """
        Whether its coordinate is prescribed.
        """
    @property
    def friction(self) -> Coulomb | None:
        """
        Its friction, or None.
        """
    @property
    def pin_radius(self) -> float | Parameter:
        """
        Where its friction acts [m].
        """
    @property
    def point(self) -> typing.Any:
        """
        In body axes (3,) [m].
        """
class Prismatic:
    """
    A slide: a rigid body moves along an axis without turning.

    The body starts with displacement [m] and rate [m/s] along the axis. Body axes are those of the world.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...], tuple[typing.Any, ...], tuple[typing.Any, ...], typing.Any, typing.Any, typing.Any]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, axis: numpy.typing.ArrayLike, *, at: numpy.typing.ArrayLike = [0.0, 0.0, 0.0], point: numpy.typing.ArrayLike = [0.0, 0.0, 0.0], motion: _Of1 | Function | None = None, friction: Coulomb | None = None) -> None:
        """
        axis (3,): a direction, of any length; at (3,): where the point is at displacement 0, both in the parent's axes (the
        world's by default); point (3,): that point of the body, body axes [m]; motion: the displacement [m] as a function of time
        [s], if it is prescribed: then the start has none; friction: Coulomb(...), a force along the axis of up to mu times what
        of the whole reaction force lies across the axis.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def at(self) -> typing.Any:
        """
        In the parent's axes (3,) [m].
        """
    @property
    def axis(self) -> typing.Any:
        """
        Its direction as given (3,), the parent's axes.
        """
    @property
    def driven(self) -> bool:
        """
        Whether its coordinate is prescribed.
        """
    @property
    def friction(self) -> Coulomb | None:
        """
        Its friction, or None.
        """
    @property
    def point(self) -> typing.Any:
        """
        In body axes (3,) [m].
        """
class Universal:
    """
    Two hinges with a massless cross between them.

    The body turns about first, fixed in its parent, and then about second, fixed in the body, at right angles at angles
    zero. It starts with angles (2,) [rad] and rates (2,) [rad/s].
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...], tuple[typing.Any, ...], tuple[typing.Any, ...], tuple[typing.Any, ...]]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, first: numpy.typing.ArrayLike, second: numpy.typing.ArrayLike, *, at: numpy.typing.ArrayLike = [0.0, 0.0, 0.0], point: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        first, second (3,): directions, of any length; at (3,): where in the parent the cross is; point (3,):
        which point of the body is held there, body axes [m].

        Also a constraint (Scene.constrain): then first is in the axes of a, second in those of b.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def at(self) -> typing.Any:
        """
        In the parent's axes (3,) [m].
        """
    @property
    def first(self) -> typing.Any:
        """
        As given (3,), the parent's axes.
        """
    @property
    def point(self) -> typing.Any:
        """
        In body axes (3,) [m].
        """
    @property
    def second(self) -> typing.Any:
        """
        As given (3,), body axes.
        """
class Cylindrical:
    """
    A hinge that slides along its axis.

    The body starts with angle [rad], rate [rad/s], displacement [m] and displacement_rate [m/s].
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...], tuple[typing.Any, ...], tuple[typing.Any, ...]]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, axis: numpy.typing.ArrayLike, *, at: numpy.typing.ArrayLike = [0.0, 0.0, 0.0], point: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        axis (3,): a direction, of any length; at (3,): where in the parent it passes; point (3,): which point of the
        body is on it, body axes [m].
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def at(self) -> typing.Any:
        """
        In the parent's axes (3,) [m].
        """
    @property
    def axis(self) -> typing.Any:
        """
        As given (3,), the parent's axes.
        """
    @property
    def point(self) -> typing.Any:
        """
        In body axes (3,) [m].
        """
class Planar:
    """
    Motion along a plane: the origin of the body's axes moves in it, and the body turns across it.

    The body starts with position (2,) [m] of its origin from at, along x and y, velocity (2,) [m/s], angle [rad] from x to y,
    and rate [rad/s].
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...], tuple[typing.Any, ...], tuple[typing.Any, ...]]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, x: numpy.typing.ArrayLike, y: numpy.typing.ArrayLike, *, at: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        x, y (3,): directions at right angles; at (3,): a point of the plane [m]; the parent's axes.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def at(self) -> typing.Any:
        """
        In the parent's axes (3,) [m].
        """
    @property
    def x(self) -> typing.Any:
        """
        As given (3,), the parent's axes.
        """
    @property
    def y(self) -> typing.Any:
        """
        As given (3,), the parent's axes.
        """
class Fixed:
    """
    A weld: no motion against the parent, in an attitude relative to it.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[tuple[float, float], tuple[float, float], tuple[float, float], tuple[float, float]], tuple[typing.Any, ...], tuple[typing.Any, ...]]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, *, attitude: _Attitude | None = None, at: numpy.typing.ArrayLike = [0.0, 0.0, 0.0], point: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        attitude: of the body in its parent, that of the parent by default; at (3,): where in the parent; point (3,): which
        point of the body is held there, body axes [m].
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def at(self) -> typing.Any:
        """
        In the parent's axes (3,) [m].
        """
    @property
    def point(self) -> typing.Any:
        """
        In body axes (3,) [m].
        """
    @property
    def rotation_matrix(self) -> typing.Any:
        """
        Body axes to the parent's (3, 3).
        """
class Plane:
    """
    A plane through a point.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...], tuple[typing.Any, ...]]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, normal: numpy.typing.ArrayLike, point: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> None:
        """
        normal (3,): a direction, of any length; point (3,) [m].
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def normal(self) -> typing.Any:
        """
        As given (3,).
        """
    @property
    def point(self) -> typing.Any:
        """
        [m] (3,).
        """
class Sphere:
    """
    A sphere as a surface: its outside, or its inside, a bowl.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...], float, bool]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, center: numpy.typing.ArrayLike, radius: typing.SupportsFloat | typing.SupportsIndex, inside: bool = False) -> None:
        """
        center (3,) [m], radius [m]; inside: what touches is in it.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def center(self) -> typing.Any:
        """
        [m] (3,).
        """
    @property
    def inside(self) -> bool:
        """
        Whether what touches is in it.
        """
    @property
    def radius(self) -> float:
        """
        [m]
        """
class Ball:
    """
    Two points coincide: a pin, a ball joint.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self) -> None:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
class Rod:
    """
    Two points keep their distance: a massless rod.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[float]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, length: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        length [m], positive.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def length(self) -> float:
        """
        [m]
        """
class Weld:
    """
    Two bodies keep the pose to each other that they start with, wherever their origins are; points given for
    both coincide. Its force and torque are at a's point.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self) -> None:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
class Hinge:
    """
    Two points coincide, and the bodies turn against each other about an axis only.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...]]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, axis: numpy.typing.ArrayLike) -> None:
        """
        axis (3,): a direction in the axes of b; as the scene starts, its axis in a too.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def axis(self) -> typing.Any:
        """
        As given (3,), axes of b.
        """
class PointOnPlane:
    """
    A point stays on a plane.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[Plane]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, plane: Plane) -> None:
        """
        plane: in the axes of b.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def plane(self) -> Plane:
        """
        In the axes of b.
        """
class PointOnCurve:
    """
    A point stays on a curve.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, curve: Curve) -> None:
        """
        curve: in the axes of b.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def curve(self) -> Curve:
        """
        In the axes of b.
        """
class Force:
    """
    A force on a body, constant or a function of time, position and velocity.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, f: _Vector | _Of3 | _Of7 | _Compiled, *, frame: typing.Literal['world', 'body'] = 'world', trace: bool | None = None) -> None:
        """
        f: a vector [N], numbers of which may be rb.parameter, or f(t, position, velocity) that returns one; with
        seven parameters f(t, x, y, z, vx, vy, vz). Position and velocity are those of the point it acts at, world axes. A C function,
        void (double t, double *position, double *velocity, double *force), is given as a numba cfunc, a SciPy LowLevelCallable
        or a ctypes function pointer.

        frame: the axes the force is in, "world", or "body", those of the rigid body it acts on.

        trace: by default a function in Python is recorded, and then runs at native speed in every engine; if it cannot be, it is
        called back, and plan() says which line is why. True: it must be recorded, else InvalidInput. False: it is called back.
        What a function raises while it is called back arrives unchanged, with the partial run as its `.run`.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def frame(self) -> str:
        """
        "world" or "body".
        """
    @property
    def function(self) -> Function | None:
        """
        The recorded function of (t, x, y, z, vx, vy, vz), if there is one.
        """
    @property
    def name(self) -> str:
        """
        Of its function.
        """
    @property
    def traced(self) -> bool:
        """
        Whether its function is recorded.
        """
class Torque:
    """
    A torque on a rigid body, constant or a function of time, attitude and angular velocity.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, f: _Vector | _Of3 | _Compiled, *, frame: typing.Literal['world', 'body'] = 'body', trace: bool | None = None) -> None:
        """
        f: a vector [N m], or f(t, rotation_matrix, angular_velocity) that returns one. The matrix (3, 3) turns body axes
        into the world's; the angular velocity [rad/s] is in the axes of the torque. A C function, void (double t,
        double *rotation_matrix, double *angular_velocity, double *torque) with the matrix row by row, is given as for Force.

        frame: the axes the torque is in, "body" or "world". trace: as for Force.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def frame(self) -> str:
        """
        "world" or "body".
        """
    @property
    def function(self) -> Function | None:
        """
        The recorded function of t, the matrix row by row, and the angular velocity, if there is one.
        """
    @property
    def name(self) -> str:
        """
        Of its function.
        """
    @property
    def traced(self) -> bool:
        """
        Whether its function is recorded.
        """
class TorsionSpring:
    """
    A spring about a hinge, with a damper, between the body and its parent.

    Its torque about the axis is -(stiffness (angle - rest_angle) + damping rate).
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[float | Parameter, float | Parameter, float | Parameter]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, stiffness: float | Parameter, rest_angle: float | Parameter = 0.0, damping: float | Parameter = 0.0) -> None:
        """
        stiffness [N m/rad] and damping [N m s], zero or positive; rest_angle [rad].
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def damping(self) -> float | Parameter:
        """
        [N m s]
        """
    @property
    def rest_angle(self) -> float | Parameter:
        """
        [rad]
        """
    @property
    def stiffness(self) -> float | Parameter:
        """
        [N m/rad]
        """
class JointTorque:
    """
    A torque about the axis of a joint: on the body, its opposite on its parent.

    Of a hinge, also one that slides or in a plane; of a universal joint about its first axis. No part of the reaction.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, f: float | _Function, *, trace: bool | None = None) -> None:
        """
        f: a number [N m], or f(t, angle, rate) that returns one. trace: as for Force.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def name(self) -> str:
        """
        Of its function.
        """
class JointForce:
    """
    A force along a slide: on the body, its opposite on its parent. No part of the reaction.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, f: float | _Function, *, trace: bool | None = None) -> None:
        """
        f: a number [N], or f(t, displacement, rate) that returns one. trace: as for Force.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def name(self) -> str:
        """
        Of its function.
        """
class Potential:
    """
    A force by its potential: F = +grad U (the chapter's sign).

    The gradient is exact: it is derived from the recorded function.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[Function, str]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, U: _Of1 | _Of3 | Function) -> None:
        """
        U: U(position), or U(x, y, z), in J; world axes. It is recorded: called once, with an array
        of three expressions. Raises InvalidInput if it cannot be; then a Force may take its place.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def function(self) -> Function:
        """
        The recorded function of (x, y, z).
        """
    @property
    def name(self) -> str:
        """
        Of its function.
        """
class Lorentz:
    """
    A force across the velocity, strength v x field: that of a uniform magnetic field.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[float | Parameter, float, float, float]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, strength: float | Parameter, field: numpy.typing.ArrayLike) -> None:
        """
        strength: a charge [C], say; field (3,): the field [T], world axes. Their product is in kg/s.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def field(self) -> typing.Any:
        """
        World axes (3,) [T], say.
        """
    @property
    def strength(self) -> float | Parameter:
        """
        A charge [C], say; strength times field is in kg/s.
        """
class Drag:
    """
    Resistance of a medium at rest: -(linear + quadratic |v|) v.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[float | Parameter, float | Parameter]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, linear: float | Parameter = 0.0, quadratic: float | Parameter = 0.0) -> None:
        """
        linear [kg/s], quadratic [kg/m]; zero or positive.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def linear(self) -> float | Parameter:
        """
        [kg/s]
        """
    @property
    def quadratic(self) -> float | Parameter:
        """
        [kg/m]
        """
class Spring:
    """
    A spring with a damper along it.

    -(stiffness (length - rest_length) + damping d(length)/dt) along the line of its ends.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[float | Parameter, float | Parameter, float | Parameter]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, stiffness: float | Parameter, rest_length: float | Parameter = 0.0, damping: float | Parameter = 0.0) -> None:
        """
        stiffness [N/m], rest_length [m], damping [kg/s]; zero or positive.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def damping(self) -> float | Parameter:
        """
        [kg/s]
        """
    @property
    def rest_length(self) -> float | Parameter:
        """
        [m]
        """
    @property
    def stiffness(self) -> float | Parameter:
        """
        [N/m]
        """
class Gravitation:
    """
    The attraction of two bodies.

    constant m_a m_b / r^2, between their centres of mass. A point of the world has no mass; it takes Central.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[float | Parameter]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, constant: float | Parameter) -> None:
        """
        constant [m^3/(kg s^2)], zero or positive.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def constant(self) -> float | Parameter:
        """
        [m^3/(kg s^2)]
        """
class Central:
    """
    A force along the line of its ends, a function of their distance.

    Its energy is found by quadrature, zero at the distance that the run starts with.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, f: _Of1 | _Compiled, *, trace: bool | None = None) -> None:
        """
        f: f(distance) -> N; positive pushes apart. A C function is double (double distance).

        trace: as for Force.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def function(self) -> Function | None:
        """
        The recorded function of the distance, if there is one.
        """
    @property
    def name(self) -> str:
        """
        Of its function.
        """
    @property
    def traced(self) -> bool:
        """
        Whether its function is recorded.
        """
class PairForce:
    """
    Any force between two bodies: one on the first, its opposite on the second.

    It keeps momentum. It need not be along the line of its ends, and then does not keep angular momentum.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, f: _Of5 | _Of13 | _Compiled, *, trace: bool | None = None) -> None:
        """
        f: f(t, r_a, r_b, v_a, v_b) -> the force on the first end (3,) [N]; places and velocities in world axes. With
        thirteen parameters they are numbers. A C function is void (double t, double *r_a, double *r_b, double *v_a, double *v_b,
        double *force).

        trace: as for Force.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def function(self) -> Function | None:
        """
        The recorded function of (t, r_a, r_b, v_a, v_b), thirteen numbers, if there is one.
        """
    @property
    def name(self) -> str:
        """
        Of its function.
        """
    @property
    def traced(self) -> bool:
        """
        Whether its function is recorded.
        """
class Handle:
    """
    What a scene returns for a body, a load or a coupling it has taken.

    Good for its scene, for copies of that scene and for their runs; equal only to itself.
    """
    def __copy__(self) -> typing.Any:
        ...
    def __deepcopy__(self, memo: dict[typing.Any, typing.Any]) -> typing.Any:
        ...
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __hash__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    @property
    def name(self) -> str:
        """
        Of what it stands for.
        """
class BodyHandle(Handle):
    """
    The handle of a body; run[handle] is a BodyMotion.
    """
    def __getstate__(self) -> tuple[int, int, str]:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def disc(self, radius: typing.SupportsFloat | typing.SupportsIndex, normal: numpy.typing.ArrayLike, center: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> BodyShape:
        """
        A disc of the body without thickness: radius [m], normal (3,) and center (3,) [m] in body axes.
        """
    def ellipsoid(self, semi_axes: numpy.typing.ArrayLike, center: numpy.typing.ArrayLike = [0.0, 0.0, 0.0], attitude: _Attitude | None = None) -> BodyShape:
        """
        An ellipsoid of the body: semi_axes (3,) [m], center (3,) [m] in body axes, attitude of its axes in the body.
        """
    def plane(self, normal: numpy.typing.ArrayLike, point: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> BodyShape:
        """
        A plane of the body: normal (3,), point (3,) [m], body axes.
        """
    def point(self, place: numpy.typing.ArrayLike) -> BodyPoint:
        """
        The point of the body at a place (3,) from the origin of its axes, body axes [m].
        """
    def sphere(self, radius: typing.SupportsFloat | typing.SupportsIndex, center: numpy.typing.ArrayLike = [0.0, 0.0, 0.0]) -> BodyShape:
        """
        A sphere of the body: radius [m], center (3,) in body axes [m].
        """
class BodyPoint:
    """
    A point of a rigid body: an end of a coupling.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[BodyHandle, tuple[typing.Any, ...]]:
        ...
    def __hash__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def body(self) -> BodyHandle:
        """
        The handle of its body.
        """
    @property
    def point(self) -> typing.Any:
        """
        In body axes (3,) [m].
        """
class LoadHandle(Handle):
    """
    The handle of a load.
    """
    def __getstate__(self) -> tuple[int, int, str]:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
class CouplingHandle(Handle):
    """
    The handle of a coupling; run[handle] is a CouplingMotion.
    """
    def __getstate__(self) -> tuple[int, int, str]:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
class WatchHandle(Handle):
    """
    The handle of a watched function; run[handle] is a Watched.
    """
    def __getstate__(self) -> tuple[int, int, str]:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
class ConstraintHandle(Handle):
    """
    The handle of a constraint; run[handle] is a ConstraintMotion.
    """
    def __getstate__(self) -> tuple[int, int, str]:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
class ContactHandle(Handle):
    """
    The handle of a contact; run[handle] is a ContactMotion.
    """
    def __getstate__(self) -> tuple[int, int, str]:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
class BodyShape:
    """
    A part of a body that touches, or a surface of it.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def body(self) -> BodyHandle:
        """
        The handle of its body.
        """
class Scene:
    """
    What there is, as data: bodies with their joints, loads, couplings, a uniform field.

    Everything is checked on entry. A run copies its scene; later changes do not touch that run.
    """
    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __copy__(self) -> Scene:
        ...
    def __deepcopy__(self, memo: dict[typing.Any, typing.Any]) -> Scene:
        ...
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getitem__(self, name: str) -> typing.Any:
        """
        The handle of a name: of a body, a coupling, a watch, a constraint, a contact or a load. Raises InvalidInput, with the names there are, for any other.
        """
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __init__(self, gravity: numpy.typing.ArrayLike | None = None) -> None:
        """
        gravity: uniform field (3,) [m/s^2], world axes; none by default.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def _repr_html_(self) -> str:
        """
        A row for each thing in a scene: what it is, its numbers, how it starts.
        """
    def add(self, body: Particle | RigidBody, joint: Free | Rail | Spherical | Revolute | Prismatic | Universal | Cylindrical | Planar | Fixed = ..., *, parent: BodyHandle | None = None, name: str | None = None, **kwargs: typing.Any) -> BodyHandle:
        """
        Adds a body with the joint to its parent, and its initial state in the joint's words.

        parent: the handle of a rigid body, or the ground. With a parent, `at`, axes and curves of the joint are in its axes, and
        the initial state is relative to it; at coordinates zero the axes of both coincide.

        A Particle, Free(): position, velocity (3,) [m], [m/s], world axes. Rail(): parameter or arc_length [m], one of them, and
        speed = ds/dt [m/s].

        A RigidBody, Free(): position, velocity of the origin of its axes, attitude, and angular_velocity (3,) [rad/s] in body
        axes or angular_velocity_world. Spherical(): attitude, angular_velocity or angular_velocity_world. Revolute(): angle
        [rad], rate [rad/s]. Prismatic(): displacement [m], rate [m/s]. Universal(): angles (2,), rates (2,). Cylindrical(): angle,
        rate, displacement, displacement_rate. Planar(): position (2,), velocity (2,), angle, rate. Fixed(): nothing. An attitude is a quaternion (w, x, y, z), a rotation
        matrix (3, 3), EulerAngles or a SciPy Rotation.

        Zero by default, body axes along the world's. Returns a handle. Raises InvalidInput for numbers that break a rule and for
        a joint that cannot hold the body, TypeError for another keyword.
        """
    def apply(self, load: Drag | Force | Lorentz | Potential | Torque | TorsionSpring | JointTorque | JointForce, handle: BodyHandle, at: numpy.typing.ArrayLike | None = None) -> LoadHandle:
        """
        Applies a load to a body. at (3,): the point of a rigid body where it acts, body axes [m]; by default the centre
        of mass. Returns a handle.
        """
    def assemble(self, keep: collections.abc.Sequence[BodyHandle] = [], *, start: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> float:
        """
        Solves the start for all constraints from the guesses given, coordinates, then rates; those of the bodies in keep stay
        as they are. start [s]: when a run is to start, which is where driven joints and rails that move are. Returns the largest
        change of a coordinate. Raises InvalidInput, with the gaps left, where there is no way.
        """
    def connect(self, coupling: Spring | Gravitation | Central | PairForce, a: _End, b: _End) -> CouplingHandle:
        """
        Joins two ends by a Spring, a Gravitation, a Central or a PairForce: handles of bodies (of a rigid body its centre of mass), points of bodies, handle.point([x, y, z]),
        or one of them a point of the world (3,) [m]. Returns a handle.
        """
    def constrain(self, constraint: Ball | Rod | Weld | Hinge | PointOnPlane | PointOnCurve | Universal, a: _End, b: _End | None = None, *, name: str | None = None) -> ConstraintHandle:
        """
        Holds a to b beside their joints: closes a loop, holds a point. Ends as in connect(); axes, planes and curves are in
        the axes of b. Without b: the world, and of two points that coincide the place where a starts. Returns a handle.

        A start that does not satisfy it is moved to the nearest that does if it is within 1e-6 of the scene's size, else a run is
        refused; assemble() finds one from rough guesses.
        """
    def contact(self, a: BodyHandle | BodyPoint | BodyShape, b: Plane | Sphere | BodyShape | BodyHandle | BodyPoint, *, friction: Coulomb | None = None, restitution: typing.SupportsFloat | typing.SupportsIndex = 0.0, name: str | None = None) -> ContactHandle:
        """
        Lets a touch b: it does not go beyond it. Returns a handle.

        a: a particle, a point of a body, or handle.sphere(), .disc(), .ellipsoid(); b: a Plane or a Sphere of the world, or
        handle.plane(), handle.sphere() of another body. restitution: Newton's, 0 to 1: what is left of the speed of approach.
        friction: Coulomb(...); none: it is smooth.

        A start may be open, closed and at rest, or closed and moving; a gap within 1e-12 of the size of what it joins is none.
        run[handle] has gap, force, slip and state; events of kind land, impact, detach, accumulation name it.
        """
    def integral(self, name: str, function: _Watched) -> None:
        """
        A first integral of one's own: function(now) as for watch(). run.drift[name] says how far it departs from its value
        at the start, relative to its largest size.
        """
    def replace(self, handle: Handle, **kwargs: typing.Any) -> None:
        """
        Lets the motion of a body start elsewhere, in the words of add(). What is not given stays as it is, an angular
        velocity in the axes it was given in. Raises what add() raises.
        """
    def watch(self, name: str, function: _Watched, *, direction: typing.Literal['either', 'rising', 'falling'] = 'either', action: typing.Literal['record', 'stop'] | _Watched = 'record', trace: bool | None = None) -> WatchHandle:
        """
        Watches a function of the motion: where it passes zero is an event of kind "watch". Returns a handle.

        function: function(now) -> number, with now.time [s] and now[handle].quantity for the quantities of BodyNow and, of a
        coupling, length and force. It is recorded, so that its zeros are found on its Taylor series, each one; what cannot be recorded is called back
        with numbers, and its zeros are located but not certain (trace as for Force).

        direction: "rising", "falling" or "either". action: "record" it, "stop" the run there, or a function of now (numbers) that
        changes the state: it returns {handle: {"velocity": ...}}, in the joint's own words as add() takes them.

        run[handle].value(t) is its value. Raises InvalidInput for a name that is taken, or a quantity that is not there.
        """
    def without(self, *args: str | LoadHandle | CouplingHandle) -> Scene:
        """
        The same scene without some of what acts in it: names of effects, handles of loads, couplings and contacts.

        Several at once:

            scene.without("drag", "static friction", spring)

        What is taken away keeps its place and does nothing, so every handle is good for the new scene and its runs. The effects:
        gravity, rotation, spring, damper, drag, gravitation, central force, user force, user torque, drive, moving rail, dynamic
        friction, static friction, contact, impact. "static friction" beside dynamic friction is what it has more than that.
        Without "rotation" a free body is a particle at its centre of mass. Without "impact" nothing bounces: restitution goes.

        Raises InvalidInput for a name that is none, and for an effect that the scene does not have or cannot be without.
        """
    @property
    def bodies(self) -> list[BodyHandle]:
        """
        Handles of the bodies, in order of addition.
        """
    @property
    def constraints(self) -> list[ConstraintHandle]:
        """
        Handles of the constraints, in order of addition.
        """
    @property
    def contacts(self) -> list[ContactHandle]:
        """
        Handles of the contacts, in order of addition.
        """
    @property
    def couplings(self) -> list[CouplingHandle]:
        """
        Handles of the couplings, in order of addition.
        """
    @property
    def gravity(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Uniform field (3,) [m/s^2], world axes. Assign a whole vector to change it.
        """
    @gravity.setter
    def gravity(self, arg1: numpy.typing.ArrayLike) -> None:
        ...
    @property
    def handles(self) -> dict[str, Handle]:
        """
        All handles of the scene by their names: bodies, loads, couplings, constraints, contacts and watches.
        """
    @property
    def loads(self) -> list[LoadHandle]:
        """
        Handles of the loads, in order of addition.
        """
    @property
    def parameters(self) -> list[typing.Any]:
        """
        The numbers by reference that it uses: each Parameter once.
        """
class BodyNow:
    """
    A body at the present moment, for watched functions.

    World axes, but where body axes are named.
    """
    def __getattr__(self, arg0: str) -> None:
        ...
    @property
    def acceleration(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of the same (3,) [m/s^2].
        """
    @property
    def angle(self) -> float:
        """
        Of a hinge, also one that slides, or in a plane [rad].
        """
    @property
    def angles(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of a universal joint, about its first axis and its second (2,) [rad].
        """
    @property
    def angular_acceleration(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        In body axes (3,) [rad/s^2]. Of a rigid body.
        """
    @property
    def angular_velocity(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        In body axes (3,) [rad/s]. Of a rigid body.
        """
    @property
    def angular_velocity_world(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        In world axes (3,) [rad/s]. Of a rigid body.
        """
    @property
    def center_of_mass(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of a rigid body (3,) [m].
        """
    @property
    def center_of_mass_acceleration(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of a rigid body (3,) [m/s^2].
        """
    @property
    def center_of_mass_velocity(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of a rigid body (3,) [m/s].
        """
    @property
    def displacement(self) -> float:
        """
        Of a slide, also of a hinge that slides [m].
        """
    @property
    def displacement_rate(self) -> float:
        """
        Of a hinge that slides [m/s].
        """
    @property
    def euler_angles(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        theta in [0, pi], psi and phi in [-pi, pi], with jumps there (3,) [rad]. Of a rigid body.
        """
    @property
    def force(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Resultant of the active forces (3,) [N].
        """
    @property
    def kinetic_energy(self) -> float:
        """
        [J]
        """
    @property
    def parameter(self) -> float:
        """
        The curve's parameter. On a rail.
        """
    @property
    def poisson_vector(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        The world's third axis in body axes (3,) (7.59). Of a rigid body.
        """
    @property
    def position(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of a particle, or of the origin of a rigid body's axes (3,) [m].
        """
    @property
    def quaternion(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (w, x, y, z), body axes to the world's (4,). Of a rigid body.
        """
    @property
    def rate(self) -> float:
        """
        Of the angle [rad/s], or of the displacement of a slide [m/s].
        """
    @property
    def rates(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of these angles (2,) [rad/s].
        """
    @property
    def reaction(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of its rail or joint (3,) [N].
        """
    @property
    def reaction_torque(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of its joint, about the point it holds (3,) [N m]. Of a rigid body.
        """
    @property
    def rotation_matrix(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Body axes to the world's (3, 3). Of a rigid body.
        """
    @property
    def speed(self) -> float:
        """
        ds/dt along the curve [m/s]. On a rail.
        """
    @property
    def tangential_force(self) -> float:
        """
        Q_s = F.t [N]. On a rail.
        """
    @property
    def velocity(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of the same (3,) [m/s].
        """
class CouplingNow:
    """
    A coupling at the present moment, for watched functions.
    """
    def __getattr__(self, arg0: str) -> None:
        ...
    @property
    def force(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        On its first end (3,) [N].
        """
    @property
    def length(self) -> float:
        """
        [m]
        """
class Now:
    """
    The present moment of a motion: what watched functions are called with.
    """
    def __getattr__(self, arg0: str) -> None:
        ...
    @typing.overload
    def __getitem__(self, handle: BodyHandle) -> BodyNow:
        ...
    @typing.overload
    def __getitem__(self, handle: CouplingHandle) -> CouplingNow:
        ...
    @property
    def time(self) -> float:
        """
        [s]
        """
class Size:
    """
    How much is integrated: the equations that a motion begins with.
    """
    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[int, int, int]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def guards(self) -> int:
        """
        Functions whose zeros are looked for.
        """
    @property
    def instructions(self) -> int:
        """
        Of the right-hand side and its guards.
        """
    @property
    def variables(self) -> int:
        """
        Of the state.
        """
class Omission:
    """
    Something a scene does not call for, and why.
    """
    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[str, str]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def what(self) -> str:
        """
        What is left out.
        """
    @property
    def why(self) -> str:
        """
        Why, or what would bring it in.
        """
class Plan:
    """
    The decisions made from a scene before anything is computed. print() shows them.
    """
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    def _repr_html_(self: Plan | SystemPlan) -> str:
        """
        What is simulated, what is left out and why.
        """
    @property
    def coordinates(self) -> list[str]:
        """
        One line for each body.
        """
    @property
    def effects(self) -> list[str]:
        """
        Effects the scene has, such as "gravity" or "static friction".
        """
    @property
    def engine(self) -> str:
        """
        The automatic choice; of several parts those of all, such as "closed form, taylor".
        """
    @property
    def freedom(self) -> int:
        """
        Degrees of freedom: those that joints and constraints leave.
        """
    @property
    def functions(self) -> list[str]:
        """
        The user's own functions: traced, or called back and why.
        """
    @property
    def guards(self) -> list[str]:
        """
        What is watched for.
        """
    @property
    def integrals(self) -> list[str]:
        """
        First integrals of the scene.
        """
    @property
    def not_unique(self) -> list[str]:
        """
        Constraints whose forces are not determined by the motion: those told have the least norm. And contacts that are closed as it starts and whose forces are not determined by it: those told are one choice.
        """
    @property
    def omissions(self) -> list[Omission]:
        """
        What is left out, and why.
        """
    @property
    def parts(self) -> list[Plan]:
        """
        Plans of the parts, bodies that nothing joins, which are solved apart; none if there is one part only.
        """
    @property
    def reason(self) -> str:
        """
        Why that engine.
        """
    @property
    def size(self) -> Size:
        """
        Of the equations that a motion from time 0 begins with; of several parts the sum.
        """
class Equilibrium:
    """
    Where a scene stays at rest, and what it does nearby (eq. 7.16).
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[list[float], bool, tuple[float, float] | None, list[float], numpy.typing.NDArray[numpy.float64], bool]:
        ...
    def __hash__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    @property
    def axes(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Directions in the world about which one body alone may be turned, and all stay at rest (k, 3).

        A heavy body on a ball joint has the vertical; `coordinates` are then one of these states. Empty where there are none.
        """
    @property
    def coordinates(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        In order of addition (n,): the parameter of a bead; x, y, z of a free particle [m]; the angle of a hinge
        [rad], in (-pi, pi] of one body alone without torsion spring; the displacement of a slide [m]; the attitude of a body on
        a ball joint, quaternion (w, x, y, z); position [m] and attitude of a free body, seven numbers.
        """
    @property
    def decided(self) -> bool:
        """
        Whether `stable` is known: not where rounding hides what forces do nearby, or it is not proven.
        """
    @property
    def interval(self) -> tuple[float, float] | None:
        """
        The coordinates of one bead, hinge or slide between which all is equilibrium, or None: what friction holds
        on a rough rail, or where no force acts along it.
        """
    @property
    def periods(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of small oscillations about it [s], the longest first; empty where there are none. (n,)
        """
    @property
    def stable(self) -> bool:
        """
        Whether U has a strict maximum there, or friction holds it. False where it is indifferent; turns about `axes`
        are left aside.
        """
class NormalModes:
    """
    Small oscillations about a state of rest.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[list[float], list[float], list[float]]:
        ...
    def __hash__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    @property
    def frequencies(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        In ascending order (n,) [rad/s]; zero where nothing pushes back, not a number where the rest is unstable.
        """
    @property
    def shapes(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        One a column (m, n), of unit length in the metric of the kinetic energy: s.M s = 1; m is n without constraints.

        The component of largest size is positive. Rows, in order of addition: the parameter of a bead; x, y, z of a free particle;
        the angle of a hinge; the displacement of a slide; the coordinates of a joint that has more; of a body that turns freely the
        place of its centre of mass, if it is free, and small turns about the body's axes [rad].
        """
    @property
    def squares(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of the frequencies, in the same order (n,) [1/s^2]; negative where the rest is unstable.
        """
class TurningPoints:
    """
    Where a motion along a rail turns round next, as parameters.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[float | None, float | None]:
        ...
    def __hash__(self) -> int:
        ...
    def __iter__(self) -> collections.abc.Iterator[typing.Any]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def above(self) -> float | None:
        """
        On the side of larger parameters; None if it does not.
        """
    @property
    def below(self) -> float | None:
        """
        On the side of smaller parameters; None if it does not.
        """
class RailPotential:
    """
    The potential of a bead along its rail at rest (eqs. 7.18-7.22), F_t = +dU/ds (the chapter's sign).

    U is zero at the beginning of the curve, or at u = 0 where it has none. A parameter is a number, or an array of any
    shape.
    """
    def __getstate__(self) -> tuple[Scene, BodyHandle]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @typing.overload
    def energy(self, u: _Numbers, speed: numpy.typing.ArrayLike = 0.0) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def energy(self, u: _Number, speed: _Number = 0.0) -> float:
        """
        m speed^2/2 - U [J] (eq. 7.20). Arrays are broadcast.
        """
    def period(self, energy: typing.SupportsFloat | typing.SupportsIndex, start: typing.SupportsFloat | typing.SupportsIndex) -> float:
        """
        The time there and back between the turning points [s] (eq. 7.22).

        On a closed curve round which it passes on: of the next round from `start`, the parameter growing. At rest in stable
        equilibrium that of small oscillations, at other equilibria and on a separatrix infinite. Raises InvalidInput for a
        motion that does not come back.
        """
    @typing.overload
    def speed(self, u: _Numbers, energy: typing.SupportsFloat | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def speed(self, u: _Number, energy: typing.SupportsFloat | typing.SupportsIndex) -> float:
        """
        |ds/dt| at u of the motion with an energy [m/s] (eq. 7.21). Raises InvalidInput where it does not come.
        """
    @typing.overload
    def tangential_force(self, u: _Numbers) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def tangential_force(self, u: _Number) -> float:
        """
        F_t = dU/ds [N] (eq. 7.15). Raises InvalidInput at a cusp.
        """
    def time(self, energy: typing.SupportsFloat | typing.SupportsIndex, u0: typing.SupportsFloat | typing.SupportsIndex, u1: typing.SupportsFloat | typing.SupportsIndex) -> float:
        """
        The time of the motion with an energy [J] straight from u0 to u1 [s] (eq. 7.22), negative if u1 < u0.

        Raises InvalidInput if it turns round before.
        """
    def turning_points(self, energy: typing.SupportsFloat | typing.SupportsIndex, start: typing.SupportsFloat | typing.SupportsIndex) -> TurningPoints:
        """
        Where the motion with an energy [J] that passes the parameter `start` turns round next, either way.

        None where it passes on for ever or the curve ends; on a curve without end that is looked for as far as 1000 Taylor
        series go. At rest in equilibrium both are the start. With the energy of a separatrix: the equilibrium that it only
        comes nearer to.
        """
    @typing.overload
    def value(self, u: _Numbers) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def value(self, u: _Number) -> float:
        """
        U [J].
        """
    @typing.overload
    def work_of_forces(self, u: _Numbers) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def work_of_forces(self, u: _Number) -> float:
        """
        The part of U that is the work of Force functions [J].
        """
class Event:
    """
    Something that happened at a time, located to rounding error. print() shows it.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[tuple[typing.Any, ...], BodyHandle | ContactHandle | None]:
        ...
    def __hash__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    def _repr_html_(self) -> str:
        """
        One line of a table of events.
        """
    @property
    def count(self) -> int:
        """
        With events="last": how many of its kind, name and subject there were.
        """
    @property
    def direction(self) -> str:
        """
        In which the watched quantity passed zero: rising, falling or either.
        """
    @property
    def impulse(self) -> float | numpy.typing.NDArray[numpy.float64]:
        """
        Of an impact [N s]: of a contact a vector (3,) on its first side, world axes, else its size.
        """
    @property
    def kind(self) -> str:
        """
        watch, reverse, stick, slip, normal-zero, rail-end, detach, land, impact, rest, accumulation or switch.
        """
    @property
    def name(self) -> str:
        """
        Of the watch or of the subject.
        """
    @property
    def note(self) -> str:
        """
        What else is to be said of it (that restitution was lowered, lest friction gain energy); empty if nothing.
        """
    @property
    def subject(self) -> BodyHandle | ContactHandle | None:
        """
        Handle of the body or the contact, or None.
        """
    @property
    def time(self) -> float:
        """
        [s]
        """
class Events:
    """
    The events of a run, a sequence in order of time.
    """
    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    @typing.overload
    def __getitem__(self, index: typing.SupportsInt | typing.SupportsIndex) -> Event:
        ...
    @typing.overload
    def __getitem__(self, slice: slice) -> list[Event]:
        ...
    def __getstate__(self) -> tuple[list[typing.Any], list[BodyHandle], list[WatchHandle], list[ContactHandle]]:
        ...
    def __iter__(self) -> collections.abc.Iterator[Event]:
        ...
    def __len__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    def _repr_html_(self) -> str:
        """
        A row an event, the first of them.
        """
    def times(self, kind_or_name: str, subject: Handle | None = None) -> numpy.typing.NDArray[numpy.float64]:
        """
        Times (n,) [s] of the events of a kind, a watch or a body, of one subject if given.

        Raises InvalidInput for what is neither a kind of event nor a name in this run.
        """
class Statistics:
    """
    The price of a run. print() shows it.
    """
    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    @property
    def changes(self) -> list[tuple[float, str]]:
        """
        Where "auto" changed the engine in the returned motion, for it was stiff or was so no longer: (time [s], engine), in order.
        """
    @property
    def events(self) -> int:
        """
        How many there are.
        """
    @property
    def guard_evaluations(self) -> int:
        """
        Of functions whose zeros are looked for, where they were called for numbers.
        """
    @property
    def integration_seconds(self) -> float:
        """
        Of it: the returned motion alone [s].
        """
    @property
    def jacobians(self) -> int:
        """
        Of the right-hand side, computed for stiff engines.
        """
    @property
    def judging_seconds(self) -> float:
        """
        Of it: all that tells the error, so the runs it is compared with; 0 with rtol= [s].
        """
    @property
    def planned(self) -> bool:
        """
        Whether it was planned anew, and not as an earlier run was.
        """
    @property
    def planning_seconds(self) -> float:
        """
        Of it: reading the scene, or finding that its plan holds [s].
        """
    @property
    def python_calls(self) -> int:
        """
        Calls of functions that could not be recorded.
        """
    @property
    def rejected(self) -> int:
        """
        Steps tried in vain.
        """
    @property
    def right_hand_sides(self) -> int:
        """
        For Taylor series: orders computed.
        """
    @property
    def runs(self) -> int:
        """
        Integrations, those for the estimate counted.
        """
    @property
    def seconds(self) -> float:
        """
        The whole call, by the clock [s].
        """
    @property
    def size(self) -> Size:
        """
        Of the equations the motion began with; of several parts the sum.
        """
    @property
    def steps(self) -> int:
        """
        Of the returned motion.
        """
class BodyMotion:
    """
    Motion of one body of a run. Each quantity is a method of time.

    t: [s], a number or an array; scalars come back as float or (n,), vectors as (3,) or (n, 3), matrices as (3, 3) or
    (n, 3, 3); world axes, but where body axes are named. side: at a jump the value "after" it, or "before". Raises
    InvalidInput for a time outside the run, and for what the body or its joint does not have.
    """
    def __repr__(self) -> str:
        ...
    def acceleration(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Of the same, from the model at the state [m/s^2].
        """
    @typing.overload
    def angle(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def angle(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        Of a hinge, also one that slides, or in a plane [rad].
        """
    def angles(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Of a universal joint, about its first axis and its second [rad]: (2,) or (n, 2).
        """
    def angular_acceleration(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        In body axes [rad/s^2]. Of a rigid body.
        """
    def angular_velocity(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        In body axes [rad/s]. Of a rigid body.
        """
    def angular_velocity_world(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        In world axes [rad/s]. Of a rigid body.
        """
    @typing.overload
    def arc_length(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def arc_length(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        From the beginning of the curve, or from u = 0 where it has none [m]. On a rail.
        """
    def center_of_mass(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [m]
        """
    def center_of_mass_acceleration(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [m/s^2]
        """
    def center_of_mass_velocity(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [m/s]
        """
    @typing.overload
    def displacement(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def displacement(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        Of a slide, also of a hinge that slides [m].
        """
    @typing.overload
    def displacement_rate(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def displacement_rate(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        Of a hinge that slides [m/s].
        """
    def euler_angles(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        theta, psi, phi, continuous in time from the start of the run [rad]. Of a rigid body.

        R = Rz(psi) Rx(theta) Rz(phi). An integrated run that keeps its end alone does not know their whole turns.
        """
    def euler_rates(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Their rates [rad/s] (eq. 7.49); not finite where sin theta = 0. Of a rigid body.
        """
    def force(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Resultant of the active forces [N].
        """
    def instantaneous_axis(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> rbdyn.frames.Axis:
        """
        The instantaneous axis of rotation: (point, direction), of a rigid body.

        point: that of the axis nearest to the centre of mass [m]; direction: of unit length, zero while the body does not turn.
        """
    @typing.overload
    def parameter(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def parameter(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        The curve's parameter. On a rail.
        """
    def point(self, place: numpy.typing.ArrayLike, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> rbdyn.frames.PointMotion:
        """
        (position, velocity) of the point of a rigid body at a place in body axes (3,) [m, m/s].
        """
    def poisson_vector(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        The world's third axis in body axes (7.59). Of a rigid body.
        """
    def position(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Of a particle, or of the origin of a rigid body's axes [m].
        """
    def quaternion(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        (w, x, y, z), body axes to the world's: (4,) or (n, 4). Of a rigid body.
        """
    @typing.overload
    def rate(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def rate(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        Of the angle [rad/s], or of the displacement of a slide [m/s].
        """
    def rates(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Of these angles [rad/s]: (2,) or (n, 2).
        """
    def reaction(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Reaction of the rail or the joint on the body [N].
        """
    def reaction_frenet(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        That of a rail along tangent, normal, binormal, which turn with it (eqs. 7.12-7.14) [N].
        """
    def reaction_torque(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Moment that the joint exerts on a rigid body, about the point it holds [N m].
        """
    def rotation_matrix(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Body axes to the world's, its columns the body's axes. Of a rigid body.
        """
    @typing.overload
    def speed(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def speed(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        ds/dt along the curve as placed [m/s], zero after a release. On a rail.
        """
    @typing.overload
    def tangential_force(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def tangential_force(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        Q_s = F.t, the active force along the curve (eq. 7.15) [N]. On a rail.
        """
    def velocity(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Of the same [m/s].
        """
    @property
    def quantities(self) -> list[str]:
        """
        Names of the quantities this body has.
        """
class BodyPointMotion:
    """
    A point fixed in a rigid body of a run, run[handle.point([x, y, z])]; each a method of time [s].
    """
    def __repr__(self) -> str:
        ...
    def acceleration(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [m/s^2], world axes.
        """
    def position(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [m], world axes.
        """
    def velocity(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [m/s], world axes.
        """
class CouplingMotion:
    """
    Length and force of a coupling of a run, each a method of time [s].
    """
    def __repr__(self) -> str:
        ...
    def force(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        On the first end [N], world axes.
        """
    @typing.overload
    def length(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def length(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        Between its ends [m].
        """
    @property
    def quantities(self) -> list[str]:
        """
        Names of the quantities a coupling has.
        """
class ConstraintMotion:
    """
    What a constraint of a run does, each a method of time [s].
    """
    def __repr__(self) -> str:
        ...
    def force(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        On its first end [N], world axes.
        """
    @typing.overload
    def gap(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def gap(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        How far its points are from where they should be [m], angles of its axes at the longest arm of what is held.
        """
    def torque(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        On its first end, about the point it holds [N m], world axes.
        """
class ContactMotion:
    """
    What a contact of a run does, each a method of time [s].
    """
    def __repr__(self) -> str:
        ...
    def force(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        On its first side, normal force and friction together [N], world axes.
        """
    @typing.overload
    def gap(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def gap(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        The distance between the part and the surface [m], negative inside.
        """
    def slip(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        The velocity of the first side's point of contact relative to the second's, along the surface [m/s].
        """
    def state(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> typing.Any:
        """
        "open", "sticks" or "slides"; a list of them for several times.
        """
class Watched:
    """
    A watched function of a run: its value at a time.
    """
    def __repr__(self) -> str:
        ...
    @typing.overload
    def value(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def value(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        At a time [s], a number or an array.
        """
    @property
    def quantities(self) -> list[str]:
        """
        Names of the quantities it has.
        """
class Trajectory:
    """
    The result of simulate(): motion, events, error estimate, price.

    run[handle] is the motion of a body or a coupling, also by its name: run["ball"]. Quantities of the whole system are
    methods of time: t [s] is a number or an array; scalars come back as float or (n,), vectors as (3,) or (n, 3), world axes;
    of: a handle or several, all bodies by default; side: at a jump the value "after" it, or "before". A run owns all it needs
    and outlives its scene.
    """
    @typing.overload
    def __getitem__(self, handle: BodyHandle) -> BodyMotion:
        ...
    @typing.overload
    def __getitem__(self, handle: BodyPoint) -> BodyPointMotion:
        ...
    @typing.overload
    def __getitem__(self, handle: CouplingHandle) -> CouplingMotion:
        ...
    @typing.overload
    def __getitem__(self, handle: ConstraintHandle) -> ConstraintMotion:
        ...
    @typing.overload
    def __getitem__(self, handle: ContactHandle) -> ContactMotion:
        ...
    @typing.overload
    def __getitem__(self, handle: WatchHandle) -> Watched:
        ...
    @typing.overload
    def __getitem__(self, handle: LoadHandle) -> typing.Never:
        ...
    @typing.overload
    def __getitem__(self, name: str) -> typing.Any:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    def _repr_html_(self: Trajectory | SystemRun) -> str:
        """
        How a run ended, with which engine, at which price, and its events.
        """
    def angular_momentum(self, t: numpy.typing.ArrayLike, pole: _Pole = [0.0, 0.0, 0.0], of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        About a pole [kg m^2/s] (7.31).

        pole: a point of the world (3,), or one for each time (n, 3) [m]; a function of time; the handle of a body, for its centre
        of mass, or a point of a body.
        """
    def animate(self, path: str | os.PathLike[str], *, fps: float = 25.0, speed: float | None = None) -> None:
        """
        Writes the motion as pictures that follow each other, a .gif, or an .mp4, which needs ffmpeg.

        fps: frames a second of playing. speed: seconds of motion in one of playing; by default 1, but for what is shorter
        than 4 s or longer than 24 s: it is played in that time. There are at most 600 frames, uniform in time. Bodies are
        drawn as what touches of them, or as the box or ball of their inertia.

        Raises ImportError if matplotlib is missing, InvalidInput for another suffix, a run without length, and where the
        system refuses.
        """
    def cardinal_residuals(self, t: numpy.typing.ArrayLike, pole: _Pole = [0.0, 0.0, 0.0], of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
        """
        (R - dQ/dt, M - dK/dt - v x Q), v the velocity of the pole [N, N m] (7.38, 7.39).

        Rounding, but for the moment of forces between the bodies that are not along their lines. Rates are from accelerations of
        the model, never from differences. pole: as of angular_momentum, but how it moves must be known: a point, a function of
        time that can be recorded, or a handle.
        """
    def center_of_mass(self, t: numpy.typing.ArrayLike, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [m]
        """
    def center_of_mass_acceleration(self, t: numpy.typing.ArrayLike, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [m/s^2]
        """
    def center_of_mass_velocity(self, t: numpy.typing.ArrayLike, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [m/s]
        """
    @typing.overload
    def energy(self, t: _Numbers, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def energy(self, t: _Number, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        T + V = T - U [J].
        """
    def external_force(self, t: numpy.typing.ArrayLike, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Resultant of what acts on the bodies from outside them [N].

        Loads, gravity, rails and joints, and couplings to the world and to other bodies.
        """
    def external_moment(self, t: numpy.typing.ArrayLike, pole: _Pole = [0.0, 0.0, 0.0], of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Moment about a pole, as of angular_momentum, of what acts on the bodies from outside them [N m].
        """
    @typing.overload
    def kinetic_energy(self, t: _Numbers, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after', *, frame: typing.Literal['world', 'center of mass'] | None = None, pole: _Pole | None = None) -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def kinetic_energy(self, t: _Number, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after', *, frame: typing.Literal['world', 'center of mass'] | None = None, pole: _Pole | None = None) -> float:
        """
        [J]

        frame: "center of mass" for that of the motion relative to axes which do not turn and move with the centre of mass of the
        bodies asked for (Koenig, 7.37); "world" by default. pole: the same with axes that move with a pole, a function of time,
        a handle or a point of a body.
        """
    def momentum(self, t: numpy.typing.ArrayLike, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        [kg m/s]
        """
    def phase_portrait(self, path: str | os.PathLike[str] | None = None, handle: BodyHandle | None = None) -> typing.Any:
        """
        A figure of the rate of a body's coordinate over it: on a rail speed over parameter, on a hinge or a slide over what
        it has turned or moved by.

        handle: the first body that has one by default. The line is broken where the rate jumps, as at an impact; a dot is
        where it ends. Written to `path`, if given. Returns the matplotlib figure.

        Raises ImportError if matplotlib is missing, InvalidInput for what has no such coordinate.
        """
    def plot(self, path: str | os.PathLike[str] | None = None, handle: BodyHandle | str | typing.Iterable[BodyHandle | str] | None = None, quantities: str | typing.Iterable[str] | None = None) -> typing.Any:
        """
        A figure of the motion over time with its events: of all bodies, of `handle`, or of several, by handles or names.

        Drawn are where each is, how fast, what holds it, and the energies of all; or `quantities`, by the names that
        run[handle].quantities has, and "energy", "kinetic_energy", "potential_energy". Written to `path`, if given.
        Returns the matplotlib figure.

        Raises ImportError if matplotlib is missing, InvalidInput for what is no body or no quantity of any.
        """
    def plot_path(self, path: str | os.PathLike[str] | None = None, *, plane: str | None = None) -> typing.Any:
        """
        A figure of where the bodies go, in space, or in a plane of the world, "xy", "xz" and so on.

        Of a rigid body, where its centre of mass goes; a dot is where each ends. Axes are equal. Written to `path`, if
        given. Returns the matplotlib figure.

        Raises ImportError if matplotlib is missing, InvalidInput for what is no plane.
        """
    @typing.overload
    def potential(self, t: _Numbers, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def potential(self, t: _Number, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        U, with F = +grad U (the chapter's sign) [J].
        """
    @typing.overload
    def potential_energy(self, t: _Numbers, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def potential_energy(self, t: _Number, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        V = -U of gravity, constant forces, potentials and couplings [J].

        Zero at the origin, at rest length, at infinity for gravitation, at the distance of the start for a central force. Of some
        bodies: with the couplings among them and to the world.
        """
    @typing.overload
    def power(self, t: _Numbers, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def power(self, t: _Number, of: Handle | collections.abc.Sequence[Handle] | None = None, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        Power of all forces on the bodies, reactions included: dT/dt (Thm 7.6) [W].

        of: bodies, or loads and couplings for theirs alone; a coupling's is that on both its ends.
        """
    def sample(self, times: numpy.typing.ArrayLike | None = None) -> rbdyn.sample.Sample:
        """
        All quantities of all bodies and couplings at times (n,) [s], by default the ends of the pieces, run.t: a rbdyn.sample.Sample.
        """
    def save(self, path: typing.Any) -> None:
        """
        Writes the run with its scene to a file, by its suffix .npz, or .h5, which needs h5py; load() reads it.

        Raises InvalidInput if a function of its scene is called back, and where the system refuses.
        """
    def view(self, path: str | os.PathLike[str] | None = None, *, fps: float = 25.0, speed: float | None = None) -> typing.Any:
        """
        The motion in space, to be turned, played and scrubbed: one HTML file that needs no network, if `path` is given.

        Shows bodies, rails, springs, what contacts are with, forces, reactions and forces of contacts as arrows of one
        scale, and the events on a line of time. Bodies are drawn as what touches of them, or as the box or ball of their
        inertia.

        fps: frames a second of playing. speed: seconds of motion in one of playing; by default 1, but for what is shorter
        than 4 s or longer than 24 s: it is played in that time. There are at most 600 frames, uniform in time.

        Returns the plotly figure, which notebooks show. Raises ImportError if plotly is missing, InvalidInput for a run
        without length, another suffix than .html or .htm, and where the system refuses.
        """
    def work(self, t0: typing.SupportsFloat | typing.SupportsIndex, t1: typing.SupportsFloat | typing.SupportsIndex, of: Handle | collections.abc.Sequence[Handle] | None = None) -> float:
        """
        Work of all forces on the bodies from t0 to t1, reactions included (Thm 7.9) [J].

        of: bodies, or loads and couplings for theirs alone. What jumps of the state (a landing, an action) make of the energy does
        not count. Raises InvalidInput for times outside the run, and where it takes a motion that was not kept (keep=).
        """
    @property
    def advice(self) -> str:
        """
        What to do about the status.
        """
    @property
    def bodies(self) -> list[BodyHandle]:
        """
        Handles of the bodies.
        """
    @property
    def certain_until(self) -> float:
        """
        The time up to which the motion is as accurate as asked for [s].
        """
    @property
    def couplings(self) -> list[CouplingHandle]:
        """
        Handles of the couplings.
        """
    @property
    def drift(self) -> dict[str, float]:
        """
        For each first integral of the scene its largest departure from the value at the start, relative to the largest
        size of its terms.
        """
    @property
    def end(self) -> float:
        """
        [s]
        """
    @property
    def engine(self) -> str:
        """
        What computed it; of several parts those of all.
        """
    @property
    def error(self) -> float | None:
        """
        Estimated global error, each quantity relative to its own scale in this motion; None with rtol.
        """
    @property
    def events(self) -> Events:
        """
        What happened, in order of time.
        """
    @property
    def plan(self) -> Plan:
        """
        What was simulated and what was left out.
        """
    @property
    def start(self) -> float:
        """
        [s]
        """
    @property
    def statistics(self) -> Statistics:
        """
        What it cost.
        """
    @property
    def status(self) -> str:
        """
        reached end, stopped by event, stopped by user, step limit, not finite, accuracy not reached or inconsistent.
        """
    @property
    def t(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        The ends of the integrator's pieces (n,) [s].
        """
class EulerTop:
    """
    A heavy rigid body with a fixed point in Euler angles (7.50-7.52, 7.58), for teaching.

    simulate(top, top.state(angles, angular_velocity), until) runs it; a state is (theta, psi, phi, theta', psi', phi')
    [rad, rad/s]. Euler angles fail at theta = 0 and pi, where the motion does not: a run ends where |sin theta| falls to
    `least`, status "stopped by event", the event "sin theta too small for Euler angles". A body of a Scene is computed in
    quaternions and goes on.
    """
    @staticmethod
    def state(angles: EulerAngles, angular_velocity: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        The state (6,) of EulerAngles and an angular velocity in body axes (3,) [rad/s].
        """
    def __init__(self, body: RigidBody, gravity: typing.SupportsFloat | typing.SupportsIndex, point: numpy.typing.ArrayLike = (0.0, 0.0, 0.0), *, least: typing.SupportsFloat | typing.SupportsIndex = 0.001) -> None:
        """
        gravity [m/s^2], along -z of the world; point (3,), the one that is held, in body axes [m].

        The body's axes are principal at that point. Raises InvalidInput for others.
        """
    def __repr__(self) -> str:
        ...
    def rates(self, state: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        The derivative (6,) of a state (6,) in time: the right side of the equations.
        """
class StateRun:
    """
    The motion of a model that is no scene: its state at any time. print() shows it.
    """
    def __getstate__(self) -> bytes:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: bytes) -> None:
        ...
    def __str__(self) -> str:
        ...
    def state(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        The variables at a time [s], or at each of an array of times; they come last.

        side: at a jump the state "after" it, or "before". Raises InvalidInput for a time the run does not hold.
        """
    @property
    def advice(self) -> str:
        """
        What to do about the status.
        """
    @property
    def certain_until(self) -> float:
        """
        The time up to which the motion is as accurate as asked for [s].
        """
    @property
    def end(self) -> float:
        """
        [s]
        """
    @property
    def engine(self) -> str:
        """
        What computed it.
        """
    @property
    def error(self) -> float | None:
        """
        Estimated global error, each variable relative to its own scale; None with rtol.
        """
    @property
    def events(self) -> list[Event]:
        """
        A list of Event in order of time.
        """
    @property
    def start(self) -> float:
        """
        [s]
        """
    @property
    def status(self) -> str:
        """
        reached end, stopped by event, stopped by user, step limit, not finite, accuracy not reached or inconsistent.
        """
class SystemNow:
    """
    The present moment of a System: what its watched functions are called with.
    """
    def __getattr__(self, arg0: str) -> typing.Any:
        ...
    def __getitem__(self, variable: str | int) -> typing.Any:
        """
        A variable by its name or place.
        """
    @property
    def time(self) -> float:
        """
        The time.
        """
    @property
    def x(self) -> float:
        """
        The state (n,).
        """
class System:
    """
    First-order equations of one's own, x' = f(t, x), simulated like a scene.

        pendulum = rb.System(lambda t, x: [x[1], -9.81 * np.sin(x[0])], [1.0, 0.0], names=["angle", "rate"])
        pendulum.watch("lowest point", lambda now: now["angle"])
        run = rb.simulate(pendulum, until=10.0)
        run.x(5.0), run["angle"].value(5.0), run.events.times("lowest point")

    Units are the user's; errors are relative to the largest size of each variable in the motion.
    """
    def __copy__(self) -> System:
        ...
    def __deepcopy__(self, memo: dict[typing.Any, typing.Any]) -> System:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __init__(self, f: _Of2 | _Compiled, x0: numpy.typing.ArrayLike, *, names: collections.abc.Sequence[str] = [], trace: bool | None = None) -> None:
        """
        f: f(t, x) -> the rates (n,) of the variables x (n,), an array or a list; x0: the state to start in (n,).

        names: of the variables. f is recorded, with the cases it distinguishes, and runs at native speed; what cannot be recorded
        is called back (trace as for Force), and so is a compiled function, void (double t, double *x, double *rates). Raises
        InvalidInput for what is no state, and for rates that are not as many.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def watch(self, name: str, function: _WatchedState, *, direction: typing.Literal['either', 'rising', 'falling'] = 'either', action: typing.Literal['record', 'stop'] | _WatchedState = 'record', trace: bool | None = None) -> None:
        """
        Watches a function of the motion: where it passes zero is an event of kind "watch".

        function: function(now) -> number, with now.time, now.x (n,) and now["angle"] or now[0]. direction: "rising", "falling" or
        "either". action: "record" it, "stop" the run there, or a function of now (numbers) that returns the state after it: all of
        it (n,), or {name or place: number}. trace as for Force. Raises InvalidInput for a name that is taken.
        """
    @property
    def f(self) -> UserFunction:
        """
        f as it is run: recorded, or called back and why.
        """
    @property
    def names(self) -> list[str]:
        """
        Of the variables; empty if they have none.
        """
    @property
    def parameters(self) -> list[typing.Any]:
        """
        The numbers by reference that it uses: each Parameter once.
        """
    @property
    def x0(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        The state it starts in (n,).
        """
class SystemPlan:
    """
    The decisions made from a System before anything is computed. print() shows them.
    """
    def __repr__(self) -> str:
        ...
    def __str__(self) -> str:
        ...
    def _repr_html_(self: Plan | SystemPlan) -> str:
        """
        What is simulated, what is left out and why.
        """
    @property
    def engine(self) -> str:
        """
        The automatic choice.
        """
    @property
    def functions(self) -> list[str]:
        """
        The user's own: traced, or called back and why.
        """
    @property
    def guards(self) -> list[str]:
        """
        What is watched for where the motion begins.
        """
    @property
    def reason(self) -> str:
        """
        Why that engine.
        """
    @property
    def size(self) -> Size:
        """
        Of the equations that a motion from time 0 begins with.
        """
    @property
    def variables(self) -> list[str]:
        """
        Their names.
        """
class SystemVariable:
    """
    A variable of a run of a System, each quantity a method of time.
    """
    def __repr__(self) -> str:
        ...
    @typing.overload
    def rate(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def rate(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        Its derivative in time there.
        """
    @typing.overload
    def value(self, t: _Numbers, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        ...
    @typing.overload
    def value(self, t: _Number, side: typing.Literal['after', 'before'] = 'after') -> float:
        """
        At a time, a number or an array.
        """
    @property
    def name(self) -> str:
        """
        Its name, or "x[2]".
        """
class SystemRun:
    """
    The motion of a System: its state at any time. print() shows it.

    run.x(t) is the state, run["theta"] or run[0] one variable. It owns all it needs and outlives its system.
    """
    def __getitem__(self, variable: str | int) -> SystemVariable:
        ...
    def __getstate__(self) -> tuple[System, bytes]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    def _repr_html_(self: Trajectory | SystemRun) -> str:
        """
        How a run ended, with which engine, at which price, and its events.
        """
    def rate(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        Its derivative in time, (n,) or (k, n): f on the side of each case distinction that the motion is on.
        """
    def sample(self, times: typing.Any = None) -> typing.Any:
        """
        A SystemSample: all variables at times (k,), by default at run.t; with tables of them.
        """
    def x(self, t: numpy.typing.ArrayLike, side: typing.Literal['after', 'before'] = 'after') -> numpy.typing.NDArray[numpy.float64]:
        """
        The state at a time (n,), or at an array of k times (k, n).

        side: at a jump the state "after" it, or "before". Raises InvalidInput for a time the run does not hold.
        """
    @property
    def advice(self) -> str:
        """
        What to do about the status.
        """
    @property
    def certain_until(self) -> float:
        """
        The time up to which the motion is as accurate as asked for.
        """
    @property
    def end(self) -> float:
        """
        Its last time.
        """
    @property
    def engine(self) -> str:
        """
        What computed it.
        """
    @property
    def error(self) -> float | None:
        """
        Estimated global error, each variable relative to its largest size in this motion; None with rtol.
        """
    @property
    def events(self) -> typing.Any:
        """
        What happened, in order of time: Events.
        """
    @property
    def names(self) -> list[str]:
        """
        Of the variables; empty if they have none.
        """
    @property
    def start(self) -> float:
        """
        Its first time.
        """
    @property
    def statistics(self) -> Statistics:
        """
        What it cost.
        """
    @property
    def status(self) -> str:
        """
        reached end, stopped by event, stopped by user, step limit, not finite, accuracy not reached or inconsistent.
        """
    @property
    def t(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        The ends of the integrator's pieces (k,).
        """
class CostRow:
    """
    One engine at one tolerance: a row of cost().
    """
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def engine(self) -> str:
        """
        What computed it.
        """
    @property
    def error(self) -> float:
        """
        Global, relative: the larger of those of the motion and of the events.
        """
    @property
    def event_error(self) -> float:
        """
        Of the times of events, over the time since the start, up to one that differs.
        """
    @property
    def events(self) -> int:
        """
        How many were found.
        """
    @property
    def events_expected(self) -> int:
        """
        How many the reference has.
        """
    @property
    def has_all_events(self) -> bool:
        """
        Whether those found are those expected.
        """
    @property
    def motion_error(self) -> float:
        """
        Of the motion, measured against the reference, in the scales of the motion; after an event that differs of places alone. Of a closed form the estimate of its rounding.
        """
    @property
    def right_hand_sides(self) -> int:
        """
        For Taylor series: orders computed.
        """
    @property
    def seconds(self) -> float:
        """
        Of the integration alone, processor time, least of the repeats; of a closed form its set-up and one state [s].
        """
    @property
    def spread(self) -> float:
        """
        Median of the repeats over the least, less 1; nan if there was time for one only.
        """
    @property
    def steps(self) -> int:
        """
        Of the integration.
        """
    @property
    def tolerance(self) -> float:
        """
        Local, the rtol= of simulate(); 0 of a closed form.
        """
    @property
    def total(self) -> float:
        """
        Of the whole call, simulate() with error= what this row reaches and its engine, planned before, processor time; nan if that was not reached or not in time [s].
        """
class MissingEngine:
    """
    An engine that is missing from a list of prices, or from its end.
    """
    def __getstate__(self) -> tuple[str, float, str, float]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def engine(self) -> str:
        """
        Its name.
        """
    @property
    def reason(self) -> str:
        """
        Why: begins with "cannot", "floor reached", "no time left" or "stiff".
        """
    @property
    def seconds(self) -> float:
        """
        What it would have taken; nan if that is not known [s].
        """
    @property
    def tolerance(self) -> float:
        """
        The first that there was no time for, or the last before its floor; 0 if it cannot do the scene.
        """
class Prediction:
    """
    What an accuracy will cost that no row has. print() shows it.
    """
    def __getstate__(self) -> tuple[str, float, float, float, str]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    @property
    def basis(self) -> str:
        """
        The rows it is read from.
        """
    @property
    def engine(self) -> str:
        """
        The quickest there.
        """
    @property
    def seconds(self) -> float:
        """
        Of the integration alone [s].
        """
    @property
    def tolerance(self) -> float:
        """
        The rtol= that leads to the error; 0 of a closed form.
        """
    @property
    def total(self) -> float:
        """
        Of simulate() with this error=; nan if that is not known [s].
        """
class Price:
    """
    What accuracy costs: a sequence of CostRow, engines over tolerances. print() shows it.
    """
    def __getitem__(self, index: typing.SupportsInt | typing.SupportsIndex) -> CostRow:
        ...
    def __getstate__(self) -> tuple[list[CostRow], list[MissingEngine], str, str, float]:
        ...
    def __iter__(self) -> collections.abc.Iterator[CostRow]:
        ...
    def __len__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    def _repr_html_(self) -> typing.Any:
        ...
    def cheapest(self, error: typing.SupportsFloat | typing.SupportsIndex) -> CostRow:
        """
        The quickest row that reaches an error and has all events. Raises InvalidInput if none does.
        """
    def front(self) -> list[CostRow]:
        """
        The rows than which none is as accurate and quicker, from loose to tight.
        """
    def plot(self, path: str | os.PathLike[str] | None = None) -> typing.Any:
        """
        The work-precision diagram: time over achieved error, written to `path` if given.

        A line an engine, dashed for the whole call; the errors of the events' times apart; the front of what is cheapest, and
        what simulate() takes by itself, are marked. Returns the matplotlib figure. Raises ImportError if matplotlib is missing.
        """
    def predict(self, error: typing.SupportsFloat | typing.SupportsIndex) -> Prediction:
        """
        What an error will cost that no row has, with the engine that is quickest there.

        Between two rows of an engine, errors, times and tolerances are interpolated in their logarithms; an error looser than an
        engine's loosest row costs what that row does. Raises InvalidInput where no engine has a row as accurate.
        """
    def to_pandas(self) -> typing.Any:
        """
        A pandas.DataFrame: a row a row, with `on_front` and `is_automatic`; what is missing is in its attrs.

        Raises ImportError if pandas is missing.
        """
    @property
    def automatic(self) -> str:
        """
        What simulate() takes by itself; "auto" where it changes the engine on the way.
        """
    @property
    def missing(self) -> list[MissingEngine]:
        """
        Engines without a row, or without one as tight as asked for.
        """
    @property
    def reference(self) -> str:
        """
        What errors are measured against, and how sure that is.
        """
    @property
    def rows(self) -> list[CostRow]:
        """
        All of them, in order.
        """
    @property
    def seconds(self) -> float:
        """
        Spent on the list, by the clock [s].
        """
class EffectRow:
    """
    What one effect does: a row of effects().
    """
    def __getstate__(self) -> tuple[str, float, float, int, int, float, int, str]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def difference(self) -> float:
        """
        Of the states with and without it at the end, in the motion's scales; nan if there is none.
        """
    @property
    def effect(self) -> str:
        """
        Its name.
        """
    @property
    def gained(self) -> int:
        """
        Events that it brings.
        """
    @property
    def lost(self) -> int:
        """
        Events that it prevents.
        """
    @property
    def note(self) -> str:
        """
        Why there are no numbers, or not all; else empty.
        """
    @property
    def seconds(self) -> float:
        """
        Of simulate() without it, least of the repeats [s].
        """
    @property
    def steps(self) -> int:
        """
        Without it.
        """
    @property
    def time(self) -> float:
        """
        Where they are compared: the earlier end of the two [s].
        """
class EffectTable:
    """
    What each effect does to motion and price: a sequence of EffectRow, also by name. print() shows it.
    """
    @typing.overload
    def __getitem__(self, index: typing.SupportsInt | typing.SupportsIndex) -> EffectRow:
        ...
    @typing.overload
    def __getitem__(self, effect: str) -> EffectRow:
        ...
    def __getstate__(self) -> tuple[list[EffectRow], float, int, int]:
        ...
    def __iter__(self) -> collections.abc.Iterator[EffectRow]:
        ...
    def __len__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def __str__(self) -> str:
        ...
    def _repr_html_(self) -> str:
        """
        What a scene is without each of its effects: the motion, its events, its price.
        """
    @property
    def events(self) -> int:
        """
        With all of them.
        """
    @property
    def rows(self) -> list[EffectRow]:
        """
        All of them, in order.
        """
    @property
    def seconds(self) -> float:
        """
        Of simulate() with all of them, least of the repeats [s].
        """
    @property
    def steps(self) -> int:
        """
        With all of them.
        """
def _bytes_of(run: Trajectory) -> bytes:
    """
    A run as data, without its scene.
    """
def _check_sweep(scene: Scene, vary: dict[typing.Any, typing.Any], count: typing.SupportsInt | typing.SupportsIndex, until: typing.SupportsFloat | typing.SupportsIndex, *, start: typing.SupportsFloat | typing.SupportsIndex, error: typing.SupportsFloat | typing.SupportsIndex | None, rtol: typing.SupportsFloat | typing.SupportsIndex | None, engine: _Engine, keep: typing.Literal['all', 'end'] | numpy.typing.ArrayLike, max_steps: typing.SupportsInt | typing.SupportsIndex, events: str) -> None:
    """
    Raises what a sweep would raise before anything runs.
    """
def _describe(function: typing.Any, signature: str, text: str) -> None:
    ...
def _function(inputs: typing.SupportsInt | typing.SupportsIndex, nodes: collections.abc.Sequence[tuple[str, typing.SupportsInt | typing.SupportsIndex, typing.SupportsInt | typing.SupportsIndex, typing.SupportsInt | typing.SupportsIndex, typing.SupportsInt | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex]], outputs: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], names: collections.abc.Sequence[str], parameters: collections.abc.Sequence[Parameter]) -> Function:
    ...
def _length(parts: collections.abc.Sequence[typing.Any]) -> typing.Any:
    ...
def _meaning(parameter: Parameter) -> typing.Any:
    ...
def _runs_from(scene: Scene, vary: dict[typing.Any, typing.Any], data: list[typing.Any]) -> list[typing.Any]:
    """
    The runs of members of a sweep from their data.
    """
def _scene_from(text: str, document: str) -> Scene:
    ...
def _scene_schema() -> str:
    ...
def _scene_text(scene: Scene) -> str:
    ...
def _sweep(scene: Scene, vary: dict[typing.Any, typing.Any], count: typing.SupportsInt | typing.SupportsIndex, until: typing.SupportsFloat | typing.SupportsIndex, *, start: typing.SupportsFloat | typing.SupportsIndex, error: typing.SupportsFloat | typing.SupportsIndex | None, rtol: typing.SupportsFloat | typing.SupportsIndex | None, engine: _Engine, keep: typing.Literal['all', 'end'] | numpy.typing.ArrayLike, max_steps: typing.SupportsInt | typing.SupportsIndex, events: str, progress: bool | collections.abc.Callable[[float], typing.Any], threads: typing.SupportsInt | typing.SupportsIndex, lanes: bool) -> tuple[typing.Any, ...]:
    """
    The runs of a sweep, what went wrong with each, and what interrupted it.
    """
def _trouble_writing(path: bytes, content: bytes) -> str:
    ...
def _user_function(kind: str, f: typing.Any, trace: bool | None = None) -> UserFunction:
    ...
def _where(condition: typing.Any, a: typing.Any, b: typing.Any, name: str = 'where') -> typing.Any:
    ...
def box(mass: typing.SupportsFloat | typing.SupportsIndex, size: numpy.typing.ArrayLike) -> RigidBody:
    """
    A block centred on the origin, its three edges along the body's axes: m (b^2 + c^2)/12 and so on.
    """
def cone(mass: typing.SupportsFloat | typing.SupportsIndex, radius: typing.SupportsFloat | typing.SupportsIndex, height: typing.SupportsFloat | typing.SupportsIndex, axis: numpy.typing.ArrayLike) -> RigidBody:
    """
    A solid cone with its apex at the origin, axis from there to the middle of its base.

    Its centre of mass is at 3/4 of its height; about it 3/10 m r^2 about the axis, 3/80 m (4 r^2 + h^2) across.
    """
@typing.overload
def cost(scene: Scene, until: typing.SupportsFloat | typing.SupportsIndex, *, start: typing.SupportsFloat | typing.SupportsIndex = 0.0, errors: numpy.typing.ArrayLike | None = None, engines: collections.abc.Sequence[_Engine] | None = None, budget: typing.SupportsFloat | typing.SupportsIndex = 5.0, progress: bool | collections.abc.Callable[[float], typing.Any] = False) -> Price:
    """
    What accuracy costs in time, for a scene: every engine over its tolerances, from loose to tight.

    until, start: times [s]. errors: global; an engine begins with the loosest as its tolerance, and is tightened until it
    reaches the tightest, or its floor; 1e-3 to 1e-12 by default. engines: all by default, "auto" among them. budget: time to
    spend by the clock, the reference included [s]. progress: True for a bar, or a function of the share of the budget that is
    spent. What could not be had within it stands in `missing`, with the time it would have taken.

    Raises InvalidInput for what breaks a rule, and what simulate() raises of a scene that has no motion up to `until`.
    """
@typing.overload
def cost(system: System, until: typing.SupportsFloat | typing.SupportsIndex, *, start: typing.SupportsFloat | typing.SupportsIndex = 0.0, errors: numpy.typing.ArrayLike | None = None, engines: collections.abc.Sequence[_Engine] | None = None, budget: typing.SupportsFloat | typing.SupportsIndex = 5.0, progress: bool | collections.abc.Callable[[float], typing.Any] = False) -> Price:
    """
    The same for first-order equations of one's own: a System.
    """
def cylinder(mass: typing.SupportsFloat | typing.SupportsIndex, radius: typing.SupportsFloat | typing.SupportsIndex, height: typing.SupportsFloat | typing.SupportsIndex, axis: numpy.typing.ArrayLike) -> RigidBody:
    """
    A solid cylinder centred on the origin: m r^2/2 about its axis, m (3 r^2 + h^2)/12 across.
    """
def disc(mass: typing.SupportsFloat | typing.SupportsIndex, radius: typing.SupportsFloat | typing.SupportsIndex, normal: numpy.typing.ArrayLike) -> RigidBody:
    """
    A thin disc centred on the origin: m r^2/2 about its normal, half of it across.
    """
def effects(scene: Scene, until: typing.SupportsFloat | typing.SupportsIndex, *, start: typing.SupportsFloat | typing.SupportsIndex = 0.0, error: typing.SupportsFloat | typing.SupportsIndex | None = None, rtol: typing.SupportsFloat | typing.SupportsIndex | None = None, engine: _Engine = 'auto', max_steps: typing.SupportsInt | typing.SupportsIndex = 100000000) -> EffectTable:
    """
    What each effect of a scene does to its motion and its price: the scene is run as it is, and without each of them.

    Arguments as for simulate(). The difference is that of the states at the end, in the scales of the motion: of each body
    the place of its centre of mass to the extent of the motion, velocity and angular velocity to their largest size (of
    whichever run has more), the attitude in radians; the largest of these. Events are gained or lost by kind, name and
    subject.

    Raises what simulate() raises for the scene as it is; what goes wrong without an effect is the note of its row.
    """
def ellipsoid(mass: typing.SupportsFloat | typing.SupportsIndex, semi_axes: numpy.typing.ArrayLike) -> RigidBody:
    """
    A solid ellipsoid centred on the origin, semi-axes along the body's axes: m (b^2 + c^2)/5 and so on.
    """
def engines() -> list[str]:
    """
    The names of the engines that this build has, as engine= takes them beside "auto".

    "closed form", "taylor" and "dop853"; with SUNDIALS "cvode-adams" and "cvode-bdf".
    """
def equilibria(scene: Scene, near: numpy.typing.ArrayLike | None = None) -> list[Equilibrium]:
    """
    The states of rest of a scene, velocities zero (eqs. 7.16, 7.60).

    One bead on a rail, one body on a hinge or a slide with all that is fixed to it: all there are, in order of the coordinate.
    A hinge is searched for one turn, with a torsion spring as far as that lets there be any, 1000 turns to both sides at most.
    A slide, a rail without ends that is not closed, or a hinge with a torque that is another one after a turn, is searched
    on both sides of `near`, its coordinate (the start otherwise), as far as 32 Taylor series on each side go, each up to twice
    as long as the one before. On a rough rail each is an `interval`. A bead that is only pressed against an end of its rail is
    in none.
    One body on a ball joint: those found from `near`, or from its start, and from attitudes spread over all; stable ones
    first. A heavy body has two, its centre of mass below and above the point that is held, free to turn about the vertical
    (`axes`): the attitudes given are those reached without such a turn.
    More freedoms: at most one, that in which a slow and damped motion from the start of the scene ends, or where that leads
    to none, one near it; given `near`, all coordinates in order of addition, the nearest of those, stable or not, that searches
    from there and from places about it lead to: by the sum of squares of the differences [m, rad], without whole turns that
    change nothing. On rough rails it is one among others. So for bodies joined to bodies and constraints, which hold there; their coordinates are those
    a scene starts with: of a joint with a parent relative to it.
    An empty list: none was found. Raises InvalidInput for a scene without bodies or with contacts, with forces or torques that
    depend on time or are called back, or with rails or joints that are driven.
    """
def normal_modes(scene: Scene, at: Equilibrium) -> NormalModes:
    """
    The small oscillations of a scene about one of its equilibria: K s = square M s.

    M is the mass matrix of the kinetic energy, K the stiffness, exact derivatives of the recorded forces. Damping and all that
    depends on velocity is left aside. Raises InvalidInput where `at` is no equilibrium, where friction holds a bead, and where
    forces depend on time, are called back, or have no potential.
    """
def parameter(value: float, name: str | None = None) -> Parameter:
    """
    A number that functions use by reference: changing its .value changes what they do from the next run on.
    """
@typing.overload
def plan(scene: Scene) -> Plan:
    """
    What a scene calls for and what it does not: coordinates, effects, guards, engine, first integrals.

    Raises InvalidInput for a scene without bodies.
    """
@typing.overload
def plan(system: System) -> SystemPlan:
    """
    The same of a System: variables, guards, functions, engine.
    """
def points(masses: numpy.typing.ArrayLike, positions: numpy.typing.ArrayLike) -> RigidBody:
    """
    Points of mass (n,) [kg] at positions (n, 3) [m], held together.
    """
def rail_potential(scene: Scene, bead: BodyHandle) -> RailPotential:
    """
    The potential of a bead of a scene along its rail at rest (eq. 7.18), also where a force has none in space.

    Raises InvalidInput, naming what stands against it, unless the tangential force depends on the place alone: friction,
    drag, dampers, a rail that moves, springs to other bodies, forces that depend on velocity or time.
    """
def ring(mass: typing.SupportsFloat | typing.SupportsIndex, radius: typing.SupportsFloat | typing.SupportsIndex, normal: numpy.typing.ArrayLike) -> RigidBody:
    """
    A thin ring centred on the origin: m r^2 about its normal, half of it across.
    """
def rod(mass: typing.SupportsFloat | typing.SupportsIndex, length: typing.SupportsFloat | typing.SupportsIndex, along: numpy.typing.ArrayLike) -> RigidBody:
    """
    A thin straight rod centred on the origin: m l^2/12 across, 0 along it.
    """
def shell(mass: typing.SupportsFloat | typing.SupportsIndex, radius: typing.SupportsFloat | typing.SupportsIndex) -> RigidBody:
    """
    A thin spherical shell centred on the origin: 2/3 m r^2.
    """
@typing.overload
def simulate(scene: Scene, until: typing.SupportsFloat | typing.SupportsIndex, *, start: typing.SupportsFloat | typing.SupportsIndex = 0.0, error: typing.SupportsFloat | typing.SupportsIndex | None = None, rtol: typing.SupportsFloat | typing.SupportsIndex | None = None, engine: _Engine = 'auto', keep: typing.Literal['all', 'end'] | numpy.typing.ArrayLike = 'all', max_steps: typing.SupportsInt | typing.SupportsIndex = 100000000, progress: bool | collections.abc.Callable[[float], typing.Any] = False, initial: _Starts | None = None, events: typing.Literal['all', 'last'] | collections.abc.Callable[[Event], typing.Any] = 'all') -> Trajectory:
    """
    Runs a scene, as accurately as asked for.

    until, start: times [s]. until may be inf where something can stop the run: a watched function with action "stop", or the
    end of a rail.
    error: global, of each quantity relative to its own scale in the motion, 1e-9 by default; the scene is run again more
    accurately until the two agree. rtol, instead of it: local tolerance only, no estimate: the cheap way.
    engine: "auto", "closed form", "taylor", "dop853", "cvode-adams" or "cvode-bdf" (engines() tells what this build has).
    keep: "all" of the motion, its "end", or times [s]. A RuntimeWarning tells, with figures, of a run that would need more
    than half of the memory there is. max_steps: of each integration.
    progress: True for a bar, or a function of the fraction done; it starts again with each integration.
    initial: where this run starts, by handle and word of add(), as in {(wheel, "rate"): 3.0}; the rest as the scene has it,
    and the scene stays as it is.
    events: "all" are kept; the "last" of each kind, name and subject with its count; or a function that is called with each
    Event of the run that is returned, once and in order, of which only those that end the run are kept then: with rtol while it
    runs, so that long runs with keep="end" take no more memory, else when it is judged.
    Bodies that nothing joins are solved apart (plan(scene).parts), and the run is one.

    Raises InvalidInput for what breaks a rule, AccuracyError if the error is out of reach, IntegrationError if the motion
    cannot be continued; the last two, KeyboardInterrupt and what `progress` raises carry the partial run as `.run`.
    Other threads run meanwhile.
    """
@typing.overload
def simulate(run: Trajectory, until: typing.SupportsFloat | typing.SupportsIndex, *, error: typing.SupportsFloat | typing.SupportsIndex | None = None, rtol: typing.SupportsFloat | typing.SupportsIndex | None = None, engine: _Engine | None = None, keep: typing.Literal['all', 'end'] | numpy.typing.ArrayLike | None = None, max_steps: typing.SupportsInt | typing.SupportsIndex | None = None, progress: bool | collections.abc.Callable[[float], typing.Any] = False, events: typing.Literal['all', 'last'] | collections.abc.Callable[[Event], typing.Any] = 'all') -> Trajectory:
    """
    Goes on with a run: from its end, or from run.certain_until if the error asked for was not reached.

    The options are those of the run where none are given; its scene and its numbers are as it had them. The motion, what
    sticks and touches, and the estimate of the error are those of a run that was not interrupted; the events at the time
    where it starts are of the run before.

    Raises what simulate() of a scene does, and InvalidInput where there is nothing to go on with: at the end of a rail.
    """
@typing.overload
def simulate(model: EulerTop, state: numpy.typing.ArrayLike, until: typing.SupportsFloat | typing.SupportsIndex, *, start: typing.SupportsFloat | typing.SupportsIndex = 0.0, error: typing.SupportsFloat | typing.SupportsIndex | None = None, rtol: typing.SupportsFloat | typing.SupportsIndex | None = None, engine: _Engine = 'auto', keep: typing.Literal['all', 'end'] | numpy.typing.ArrayLike = 'all', max_steps: typing.SupportsInt | typing.SupportsIndex = 100000000, progress: bool | collections.abc.Callable[[float], typing.Any] = False) -> StateRun:
    """
    Runs a model of its own from a state, as accurately as asked for: an EulerTop, and its six variables.

    The options are those of a scene; "auto" is "taylor". error: of each variable relative to its own scale.
    """
@typing.overload
def simulate(system: System, until: typing.SupportsFloat | typing.SupportsIndex, *, start: typing.SupportsFloat | typing.SupportsIndex = 0.0, error: typing.SupportsFloat | typing.SupportsIndex | None = None, rtol: typing.SupportsFloat | typing.SupportsIndex | None = None, engine: _Engine = 'auto', keep: typing.Literal['all', 'end'] | numpy.typing.ArrayLike = 'all', max_steps: typing.SupportsInt | typing.SupportsIndex = 100000000, progress: bool | collections.abc.Callable[[float], typing.Any] = False, initial: numpy.typing.ArrayLike | collections.abc.Mapping[str | int, float] | None = None, events: typing.Literal['all', 'last'] | collections.abc.Callable[[Event], typing.Any] = 'all') -> SystemRun:
    """
    Runs first-order equations of one's own, as accurately as asked for: a System.

    The options are those of a scene; "auto" is "taylor", or "dop853" where f is called back. error: of each variable relative
    to its largest size. initial: the state this run starts in, (n,) or {name or place: number}.

    Raises what simulate() of a scene does; the errors carry the partial run as `.run`.
    """
def solid(density: float | _Of3, bounds: collections.abc.Sequence[typing.Any], *, error: typing.SupportsFloat | typing.SupportsIndex = 1e-12) -> RigidBody:
    """
    A body from its density, by quadrature (as in eqs. 7.28, 7.30b, 7.33 and 7.36).

    density: a number, or a function of x, y, z [m] that gives kg/m^3, zero or positive; it is called with arrays, and with
    floats if it cannot take arrays.

    bounds: three ranges [m], as in [(0, 1), (0, 2), (0, 3)]; that of y may be a function of x, and that of z one of x
    and y, which give (from, to).

    error: relative, of mass, centre of mass and inertia. Raises InvalidInput if it is out of reach, as for a density that
    jumps: then give the bounds of each part as functions and add the parts.
    """
def sphere(mass: typing.SupportsFloat | typing.SupportsIndex, radius: typing.SupportsFloat | typing.SupportsIndex) -> RigidBody:
    """
    A solid ball centred on the origin: 2/5 m r^2.
    """
__version__: str = '0.1.0'
_functions: dict[typing.Any, typing.Any]
