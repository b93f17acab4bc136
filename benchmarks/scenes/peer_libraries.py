"""Other libraries, given the problems of beside_peers.py, and this one.

Each function gives, for a problem, runs by name: a function of the tolerance that gives the numbers that are compared
and the seconds of the thread that it took, and what was paid once, in seconds: planning or compilation.
"""

import math
import time

# --- equations as text: floats and machine code from one source ---


class Text:
    """An expression that writes itself down, each result once."""

    lines: list = []

    def __init__(self, text):
        self.text = text

    @classmethod
    def of(cls, value):
        return value if isinstance(value, Text) else Text(repr(float(value)))

    @classmethod
    def made(cls, text):
        name = f"k{len(cls.lines)}"
        cls.lines.append(f"{name} = {text}")
        return Text(name)

    def _with(self, sign, other, is_left=True):
        a, b = (self, Text.of(other)) if is_left else (Text.of(other), self)
        return Text.made(f"{a.text} {sign} {b.text}")

    def __add__(self, other):
        return self._with("+", other)

    def __radd__(self, other):
        return self._with("+", other, False)

    def __sub__(self, other):
        return self._with("-", other)

    def __rsub__(self, other):
        return self._with("-", other, False)

    def __mul__(self, other):
        return self._with("*", other)

    def __rmul__(self, other):
        return self._with("*", other, False)

    def __truediv__(self, other):
        return self._with("/", other)

    def __rtruediv__(self, other):
        return self._with("/", other, False)

    def __neg__(self):
        return Text.made(f"-{self.text}")


class Texts:
    """The functions that equations ask for."""

    sin = staticmethod(lambda x: Text.made(f"math.sin({Text.of(x).text})"))
    cos = staticmethod(lambda x: Text.made(f"math.cos({Text.of(x).text})"))
    sqrt = staticmethod(lambda x: Text.made(f"math.sqrt({Text.of(x).text})"))


def source_of(slopes, count):
    """The body of a function of s[0] .. s[count - 1], and the text of what it gives."""
    Text.lines = []
    results = [Text.of(r).text for r in slopes([Text(f"s[{i}]") for i in range(count)], Texts)]
    return Text.lines, results


def python_function(slopes, count):
    lines, results = source_of(slopes, count)
    space = {"math": math}
    exec("def f(t, s):\n    s = s.tolist()\n    " + "\n    ".join([*lines, f"return [{', '.join(results)}]"]), space)
    return space["f"]


def library(problem):
    import rbdyn as rb

    scene, until = problem.scene()
    begin = time.perf_counter()
    plan = rb.plan(scene)
    once = time.perf_counter() - begin

    def with_engine(engine):
        def go(tolerance):
            begin = time.thread_time()
            run = rb.simulate(scene, until, rtol=max(tolerance, 1e-16), engine=engine, keep="end")
            seconds = time.thread_time() - begin
            return problem.read(run), seconds

        return go, once

    names = ["auto", *([] if plan.engine == "taylor" else ["taylor"]), "dop853"]
    return {f"rbdyn, {plan.engine if n == 'auto' else n}": with_engine(n) for n in names}


def with_error(problem):
    """The whole call that promises an error: numbers, seconds and the same in integrations of the run it returns."""
    import rbdyn as rb

    scene, until = problem.scene()

    def go(error):
        begin = time.thread_time()
        run = rb.simulate(scene, until, error=error, engine="taylor", keep="end")
        seconds = time.thread_time() - begin
        paid = run.statistics
        return problem.read(run), seconds, paid.seconds, paid.integration_seconds

    return go


def with_heyoka(problem):
    import heyoka

    count = len(problem.start)
    variables = heyoka.make_vars(*(f"x{i}" for i in range(count)))
    made, once = {}, [0.0]

    def compiled(tolerance):
        begin = time.perf_counter()
        result = {}
        for name, mode in problem.modes.items():
            system = list(zip(variables, map(heyoka.expression, mode.slopes(variables, heyoka)), strict=True))
            directions = {1: heyoka.event_direction.positive, -1: heyoka.event_direction.negative}
            events = [
                heyoka.t_event(heyoka.expression(value(variables, heyoka)), direction=directions[way])
                for value, way, _ in mode.guards
            ]
            result[name] = heyoka.taylor_adaptive(
                system,
                list(problem.start),
                tol=tolerance,
                compact_mode=count > 20,
                **({"t_events": events} if events else {}),
            )
        once[0] = max(once[0], time.perf_counter() - begin)
        return result

    def go(tolerance):
        if tolerance not in made:
            made[tolerance] = compiled(tolerance)
        begin = time.thread_time()
        name, state, now, last = problem.first, problem.start, 0.0, 0.0
        while True:
            integrator = made[tolerance][name]
            integrator.time = now
            integrator.state[:] = state
            if problem.modes[name].guards:
                integrator.reset_cooldowns()
            outcome = int(integrator.propagate_until(problem.until)[0].value)
            now, state = integrator.time, integrator.state.tolist()
            if outcome == heyoka.taylor_outcome.time_limit.value:
                break
            last = now
            index = -outcome - 1 if outcome < 0 else outcome
            following = problem.modes[name].guards[index][2](state)
            if following is None:
                break
            name, state = following
        seconds = time.thread_time() - begin
        return problem.told(list(state), last), seconds

    go(1e-3)
    return {"heyoka": (go, once[0])}


def with_numbalsoda(problem):
    import numba
    import numbalsoda
    import numpy as np

    if len(problem.modes) > 1 or problem.modes["only"].guards:
        return {}
    start, times = np.array(problem.start, float), np.array([0.0, problem.until])
    begin = time.perf_counter()
    lines, results = source_of(problem.modes["only"].slopes, len(start))
    text = "def f(t, s, out, p):\n    " + "\n    ".join([*lines, *(f"out[{i}] = {r}" for i, r in enumerate(results))])
    space = {"math": math}
    exec(text, space)
    address = numba.cfunc(numbalsoda.lsoda_sig)(space["f"]).address
    once = time.perf_counter() - begin

    def with_method(method, least):
        def go(tolerance):
            tolerance = max(tolerance, least)
            begin = time.thread_time()
            states, ok = method(address, start, times, rtol=tolerance, atol=tolerance, mxstep=10**7)
            seconds = time.thread_time() - begin
            return (problem.told(states[-1].tolist(), 0.0) if ok else None), seconds

        return go, once

    return {
        "numbalsoda, dop853": with_method(numbalsoda.dop853, 0.0),
        "numbalsoda, lsoda": with_method(numbalsoda.lsoda, 1e-13),
    }


def with_scipy(problem):
    from scipy.integrate import solve_ivp

    functions, guards = {}, {}
    for name, mode in problem.modes.items():
        functions[name] = python_function(mode.slopes, len(problem.start))
        guards[name] = []
        for value, way, _ in mode.guards:

            def guard(t, s, value=value):
                return value([float(x) for x in s], math)

            guard.terminal, guard.direction = True, way
            guards[name].append(guard)

    def with_method(method):
        def go(tolerance):
            begin = time.thread_time()
            name, state, now, last = problem.first, problem.start, 0.0, 0.0
            while now < problem.until:
                done = solve_ivp(
                    functions[name],
                    (now, problem.until),
                    state,
                    method=method,
                    rtol=max(tolerance, 3e-14),
                    atol=tolerance,
                    events=guards[name] or None,
                )
                now, state = done.t[-1], done.y[:, -1].tolist()
                if done.status != 1:
                    break
                last = now
                index = next(i for i, times in enumerate(done.t_events) if len(times))
                following = problem.modes[name].guards[index][2](done.y_events[index][0].tolist())
                if following is None:
                    break
                name, state = following
            seconds = time.thread_time() - begin
            return problem.told(state, last) if done.status >= 0 else None, seconds

        return go, 0.0

    return {f"SciPy, {method}": with_method(method) for method in ("DOP853", "LSODA", "Radau")}


def with_sundae(problem):
    import numpy as np
    from sksundae.cvode import CVODE

    if len(problem.modes) > 1 or problem.modes["only"].guards:
        return {}
    function = python_function(problem.modes["only"].slopes, len(problem.start))

    def slopes(t, y, out):
        out[:] = function(t, y)

    def with_method(method):
        def go(tolerance):
            begin = time.thread_time()
            solver = CVODE(slopes, method=method, rtol=max(tolerance, 1e-15), atol=tolerance, max_num_steps=10**7)
            done = solver.solve(np.array([0.0, problem.until]), np.array(problem.start, float))
            seconds = time.thread_time() - begin
            return (problem.told(done.y[-1].tolist(), 0.0) if done.success else None), seconds

        return go, 0.0

    return {f"scikit-sundae, {method}": with_method(method) for method in ("Adams", "BDF")}
