"""What an error costs in time, beside heyoka, numbalsoda, SciPy, scikit-sundae, MuJoCo and Drake on this machine.

The problems of scenes/beside_peers.py: each library integrates the same equations of first order, with modes and
events by hand where there are any; this library is given the scene. Milliseconds of the call, nothing kept but the
end, what is set up once left out: planning here, compilation there, which have columns of their own. Tolerances by
tens, from loose to tight; of those that reach an error the quickest counts, and the chosen ones then take turns.
Errors at the end: of positions (attitudes, angles) and of rates, each relative to its own size, against this
library's tightest run, in closed form where there is one.

Libraries are installed into an environment of their own in build/peers, from where this file runs itself again; those
that cannot be are named. Writes docs/peers.md and docs/peers.svg; problems that are named are only printed.
"""

import datetime
import importlib.util
import math
import os
import platform
import signal
import subprocess
import sys
import time
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
HOME = ROOT / "build" / "peers"
PACKAGES = {"scipy": "scipy", "matplotlib": "matplotlib", "heyoka": "heyoka", "numbalsoda": "numbalsoda"}
PACKAGES |= {"sksundae": "scikit-sundae", "mujoco": "mujoco", "pydrake": "drake"}
ERRORS = (1e-6, 1e-9, 1e-12)
TOLERANCES = [10.0**-k for k in range(3, 17)]
# s: a run that takes longer ends its ladder; turns of the chosen runs
LIMIT, TURNS = 2.0, 5


def in_its_own_environment():
    """Goes on in build/peers, made first where it is not there. Returns what could not be installed."""
    if Path(sys.prefix).resolve() == HOME.resolve():
        return [name for name in PACKAGES if importlib.util.find_spec(name) is None]
    python = HOME / "bin" / "python"
    if not (HOME / "installed").exists():
        venv.create(HOME, with_pip=True, clear=True)
        for package in PACKAGES.values():
            command = [python, "-m", "pip", "install", "-q", package]
            if subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode != 0:
                print(f"{package} cannot be installed here", flush=True)
        (HOME / "installed").touch()
    # this library and what it needs, behind the environment's own packages
    behind = os.pathsep.join(p for p in sys.path[1:] if p)
    environment = {**os.environ, "RBDYN_BEHIND": behind}
    sys.exit(subprocess.run([python, __file__, *sys.argv[1:]], env=environment).returncode)


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


# --- each: for a problem, functions of the tolerance that give (numbers compared, seconds), by name, what was paid once


def library(problem):
    import rbdyn as rb

    scene, until = problem.scene()
    begin = time.perf_counter()
    plan = rb.plan(scene)
    once = time.perf_counter() - begin

    def with_engine(engine):
        def go(tolerance):
            begin = time.perf_counter()
            run = rb.simulate(scene, until, rtol=max(tolerance, 1e-16), engine=engine, keep="end")
            seconds = time.perf_counter() - begin
            return problem.read(run), seconds

        return go, once

    names = ["auto", *([] if plan.engine == "taylor" else ["taylor"])]
    return {f"rbdyn, {plan.engine if n == 'auto' else n}": with_engine(n) for n in names}


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
        begin = time.perf_counter()
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
        seconds = time.perf_counter() - begin
        return problem.told(list(state), last), seconds

    go(TOLERANCES[0])
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
            begin = time.perf_counter()
            states, ok = method(address, start, times, rtol=tolerance, atol=tolerance, mxstep=10**7)
            seconds = time.perf_counter() - begin
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
            begin = time.perf_counter()
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
            seconds = time.perf_counter() - begin
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
            begin = time.perf_counter()
            solver = CVODE(slopes, method=method, rtol=max(tolerance, 1e-15), atol=tolerance, max_num_steps=10**7)
            done = solver.solve(np.array([0.0, problem.until]), np.array(problem.start, float))
            seconds = time.perf_counter() - begin
            return (problem.told(done.y[-1].tolist(), 0.0) if done.success else None), seconds

        return go, 0.0

    return {f"scikit-sundae, {method}": with_method(method) for method in ("Adams", "BDF")}


def exact_numbers(problem):
    """This library's tightest run, and what it tells of its error."""
    import rbdyn as rb

    scene, until = problem.scene()
    for error in (1e-14, 1e-13, 3e-13, 1e-12, 1e-11):
        try:
            run = rb.simulate(scene, until, error=error)
            return problem.read(run), run.error
        except rb.AccuracyError:
            continue
    raise RuntimeError(f"{problem.about}: nothing to measure errors against")


def difference(numbers, exact, groups):
    import numpy as np

    if numbers is None or not np.all(np.isfinite(numbers)):
        return math.inf
    numbers, exact = np.asarray(numbers, float), np.asarray(exact, float)
    return max(np.linalg.norm(numbers[g] - exact[g]) / np.linalg.norm(exact[g]) for g in groups)


def measured(problem, exact):
    """For each run by name: what it paid once, and by error (tolerance, error, seconds), as far as it reaches."""
    from scenes.multibody import with_drake, with_mujoco

    runs, chosen = {}, {}
    for peer in (library, with_heyoka, with_numbalsoda, with_scipy, with_sundae, with_mujoco, with_drake):
        try:
            runs |= peer(problem)
        except ImportError:
            continue
    for name, (go, _) in runs.items():
        rows = []
        for tolerance in TOLERANCES:
            try:
                # compilation may take longer
                signal.setitimer(signal.ITIMER_REAL, 60.0 if name == "heyoka" else 2 * LIMIT)
                numbers, seconds = go(tolerance)
            except Exception as reason:  # a peer that gives up, or has no time left, is shown without a number
                print(f"{name} at {tolerance:g}: {reason}", file=sys.stderr)
                break
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)
            seconds = min([seconds] + [go(tolerance)[1] for _ in range(3 if seconds < 0.05 else 0)])
            rows.append((seconds, tolerance, difference(numbers, exact, problem.groups)))
            if seconds > LIMIT or rows[-1][2] <= ERRORS[-1]:
                break
        for error in ERRORS:
            best = min((row for row in rows if row[2] <= error), default=None)
            if best:
                chosen[name, error] = [best[1], best[2], best[0]]
    for _ in range(TURNS):
        for (name, _), row in chosen.items():
            if row[2] < 0.3:
                row[2] = min(row[2], *(runs[name][0](row[0])[1] for _ in range(2)))
    return {
        name: (once, {e: chosen[name, e] for e in ERRORS if (name, e) in chosen}) for name, (_, once) in runs.items()
    }


# --- what is written ---


def table(results, told):
    from scenes.beside_peers import PROBLEMS

    lines = ["| | | 1e-6 | 1e-9 | 1e-12 | once |", "|---|---|---|---|---|---|"]
    for name, found in results.items():
        least = {e: min((row[e][2] for _, row in found.values() if e in row), default=0.0) for e in ERRORS}
        for i, (label, (once, row)) in enumerate(found.items()):
            cells = []
            for error in ERRORS:
                text = f"{1e3 * row[error][2]:.3g}" if error in row else "-"
                cells.append(f"**{text}**" if error in row and row[error][2] == least[error] else text)
            head = f"{name}: {PROBLEMS[name].about}" if i == 0 else ""
            lines.append(f"| {head} | {label} | {' | '.join(cells)} | {1e3 * once:.3g} |")
    lines += ["", "Errors are against runs that tell " + ", ".join(f"{e:.0e} ({n})" for n, e in told.items()) + "."]
    return "\n".join(lines)


def figure(results, path):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "rbdyn", "svg.fonttype": "none", "font.size": 9})
    drawn, axes = plt.subplots(1, len(ERRORS), figsize=(11, 4.6), sharey=True, layout="constrained")
    families = sorted(
        {label.split(",")[0] for found in results.values() for label in found}, key=lambda f: f != "rbdyn"
    )
    for axis, error in zip(axes, ERRORS, strict=True):
        for k, family in enumerate(families):
            points = []
            for i, found in enumerate(results.values()):
                times = [r[error][2] for label, (_, r) in found.items() if label.split(",")[0] == family and error in r]
                if times:
                    points.append((1e3 * min(times), i))
            axis.plot(*zip(*points, strict=True), "o^sDvPX*"[k], label=family, alpha=0.8) if points else None
        axis.set(xscale="log", xlabel="ms", title=f"error {error:.0e}", yticks=range(len(results)))
        axis.set_yticklabels(results)
        axis.grid(alpha=0.3)
    axes[0].invert_yaxis()
    drawn.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(families))
    drawn.savefig(path, metadata={"Date": None})


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "")
    return model or platform.processor() or platform.machine()


def main():
    for place in os.environ.get("RBDYN_BEHIND", "").split(os.pathsep):
        if place and place not in sys.path:
            sys.path.append(place)
    missing = in_its_own_environment()
    from importlib.metadata import version

    import rbdyn as rb
    from scenes.beside_peers import PROBLEMS

    def stop(*_):
        raise TimeoutError("it takes too long")

    signal.signal(signal.SIGALRM, stop)
    results, told = {}, {}
    for name in sys.argv[1:] or PROBLEMS:
        exact, told[name] = exact_numbers(PROBLEMS[name])
        results[name] = measured(PROBLEMS[name], exact)
        print(table({name: results[name]}, {name: told[name]}), flush=True)
    for name in missing:
        print(f"{PACKAGES[name]} could not be installed")
    if len(sys.argv) > 1:
        return
    figure(results, ROOT / "docs" / "peers.svg")
    there = [f"{p} {version(p)}" for name, p in PACKAGES.items() if name not in (*missing, "matplotlib")]
    absent = [PACKAGES[name] for name in missing]
    text = f"""# Beside other libraries

`./run bench peers` installs them into an environment of their own and writes this page on your machine. This one is of
{datetime.date.today():%d %B %Y}: {machine()}, shared with other work; rbdyn {rb.__version__}, {", ".join(there)}{
        "; not installed: " + ", ".join(absent) if absent else ""
    }.

Milliseconds to reach an error, the least of {2 * TURNS} and more in turns; bold: the least. "-": not reached, or in no
{LIMIT:g} s. Each library integrates the same equations, its modes and events written by hand; rbdyn is given the scene.
Nothing is kept but the end. **once**: planning or compilation, not in the other columns: here of the scene, of heyoka
for each tolerance, of numbalsoda for each system. SciPy and scikit-sundae call a Python function with floats.

![The quickest way of each library, by scene and error.](peers.svg)

{table(results, told)}

Errors are of positions (attitudes, angles) and of rates at the end, each relative to its
own size; where the hoop sticks, and when.
numbalsoda and scikit-sundae are left out where there are events. MuJoCo and Drake are given bars and hinges, as rbdyn
is; MuJoCo closes loops by stiff springs, Drake has no loops in continuous time.
"""
    (ROOT / "docs" / "peers.md").write_text(text)


if __name__ == "__main__":
    main()
