"""What an error costs in time, beside heyoka, numbalsoda, SciPy, scikit-sundae, MuJoCo and Drake on this machine.

The problems of scenes/beside_peers.py, given to libraries by scenes/peer_libraries.py and multibody.py: each integrates
the same equations of first order, with modes and events by hand where there are any; this library is given the scene.
Milliseconds of the thread for the call, nothing kept but the end, what is set up once left out: planning here,
compilation there, which have a column of their own; heyoka has a row with its compilation, too. Tolerances by tens,
from loose to tight; of those that reach an error the quickest counts, and the chosen ones then take turns.
Errors at the end: of positions (attitudes, angles) and of rates, each relative to its own size, against this
library's tightest run, in closed form where there is one.

"rbdyn, taylor, error=" is the whole call that promises an error. Below the table stand geometric means over problems
and errors: of heyoka's time over that of this library's series, of numbalsoda's DOP853 over this one's, of integrations
that a call with error= takes, and of heyoka's batch over members of a sweep (lanes.py).

Libraries are installed into an environment of their own in build/peers, from where this file runs itself again; those
that cannot be are named. Writes docs/peers.md and docs/peers.svg; problems that are named, and "ensembles", are only
printed.
"""

import datetime
import importlib.util
import math
import os
import platform
import signal
import subprocess
import sys
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
LIBRARY, DOP853, PROMISE = "rbdyn, taylor", "rbdyn, dop853", "rbdyn, taylor, error="


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


def with_promise(problem, exact):
    """The call that promises an error: (error asked for, error, seconds, integrations it takes) by error."""
    import rbdyn as rb
    from scenes.peer_libraries import with_error

    go, found = with_error(problem), {}
    for error in ERRORS:
        try:
            numbers, seconds, whole, integration = go(error)
            for _ in range(4 * TURNS if seconds < 0.05 else TURNS):
                _, again, *paid = go(error)
                seconds, whole, integration = min(seconds, again), min(whole, paid[0]), min(integration, paid[1])
        except rb.AccuracyError:
            continue
        found[error] = [error, difference(numbers, exact, problem.groups), seconds, whole / integration]
    return found


def measured(problem, exact):
    """For each run by name: what it paid once, and by error (tolerance, error, seconds), as far as it reaches."""
    from scenes import multibody, peer_libraries

    runs, chosen = {}, {}
    for module, peers in (
        (peer_libraries, ("library", "with_heyoka", "with_numbalsoda", "with_scipy", "with_sundae")),
        (multibody, ("with_mujoco", "with_drake")),
    ):
        for peer in peers:
            try:
                runs |= getattr(module, peer)(problem)
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
    found = {
        name: (once, {e: chosen[name, e] for e in ERRORS if (name, e) in chosen}) for name, (_, once) in runs.items()
    }
    result = {}
    for name, (once, row) in found.items():
        # contacts are held by Taylor series alone
        if name == DOP853 and not row:
            continue
        result[name] = once, row
        if name == LIBRARY:
            result[PROMISE] = once, with_promise(problem, exact)
        if name == "heyoka":
            result["heyoka, with its compilation"] = 0.0, {e: [*r[:2], r[2] + once] for e, r in row.items()}
    return result


# --- what the aims ask for ---


def mean(numbers):
    numbers = list(numbers)
    return math.exp(sum(map(math.log, numbers)) / len(numbers)) if numbers else math.nan


def times_as_quick(results, one, other):
    """By problem: the geometric mean over errors of the other's time over one's, where both reach an error."""
    ratios = {}
    for name, found in results.items():
        if one in found and other in found:
            a, b = found[one][1], found[other][1]
            both = [b[e][2] / a[e][2] for e in ERRORS if e in a and e in b]
            if both:
                ratios[name] = mean(both)
    return ratios


def summary(results):
    """Geometric means over problems, and what each has in them."""
    closed = [name for name, found in results.items() if any("closed form" in label for label in found)]
    lines = []

    def add(about, ratios):
        if ratios:
            each = ", ".join(f"{name} {ratio:.2f}" for name, ratio in ratios.items())
            lines.append(f"* {about}: **{mean(ratios.values()):.2f}** ({each})")

    beside = times_as_quick(results, LIBRARY, "heyoka")
    add("speed of Taylor series beside heyoka, times", beside)
    add("the same without problems in closed form", {n: r for n, r in beside.items() if n not in closed})
    add("speed of DOP853 beside numbalsoda's, times", times_as_quick(results, DOP853, "numbalsoda, dop853"))
    promised = {name: found[PROMISE][1] for name, found in results.items() if PROMISE in found}
    add(
        "integrations a call with `error=`", {n: mean(r[3] for r in row.values()) for n, row in promised.items() if row}
    )
    return "\n".join(lines)


def ensembles():
    """Members of a sweep beside heyoka's batch, as text."""
    import lanes

    found = lanes.members_of_n()
    lines = [f"| N, microseconds a member | {' | '.join(f'{e:.0e}' for e in ERRORS)} |", "|---|" + "---|" * len(ERRORS)]
    lines += [f"| {name} | {' | '.join(f'{us:.0f}' if us > 0 else '-' for us in row)} |" for name, row in found.items()]
    own = found["rbdyn, side by side"]
    for name, row in found.items():
        if name.startswith("heyoka"):
            ratio = mean(b / a for a, b in zip(own, row, strict=True) if a > 0 and b > 0)
            lines += [
                "" if not lines[-1].startswith("*") else None,
                f"* speed of members beside {name}, times: **{ratio:.2f}**",
            ]
    return "\n".join(line for line in lines if line is not None)


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
    named = sys.argv[1:]
    for name in [n for n in named if n != "ensembles"] or ([] if named else PROBLEMS):
        exact, told[name] = exact_numbers(PROBLEMS[name])
        results[name] = measured(PROBLEMS[name], exact)
        print(table({name: results[name]}, {name: told[name]}), flush=True)
    if results:
        print(summary(results), flush=True)
    for name in missing:
        print(f"{PACKAGES[name]} could not be installed")
    if named and "ensembles" not in named:
        return
    beside = ensembles()
    print(beside, flush=True)
    if named:
        return
    figure(results, ROOT / "docs" / "peers.svg")
    there = [f"{p} {version(p)}" for name, p in PACKAGES.items() if name not in (*missing, "matplotlib")]
    absent = [PACKAGES[name] for name in missing]
    text = f"""# Beside other libraries

`./run bench peers` installs them into an environment of their own and writes this page on your machine. This one is of
{datetime.date.today():%d %B %Y}: {machine()}; rbdyn {rb.__version__}, {", ".join(there)}{
        "; not installed: " + ", ".join(absent) if absent else ""
    }.

Milliseconds of the thread to reach an error, the least of {
        2 * TURNS
    } and more in turns; bold: the least. "-": not reached, or in no
{LIMIT:g} s. Each library integrates the same equations, its modes and events written by hand; rbdyn is given the scene.
Nothing is kept but the end. **once**: planning or compilation, not in the other columns: here of the scene, of heyoka
for each tolerance, of numbalsoda for each system. **error=**: the whole call that promises the error. SciPy and
scikit-sundae call a Python function with floats.

![The quickest way of each library, by scene and error.](peers.svg)

{table(results, told)}

{summary(results)}

{beside}

Errors are of positions (attitudes, angles) and of rates at the end, each relative to its
own size; where the hoop sticks, and when.
numbalsoda and scikit-sundae are left out where there are events, `dop853` where there are contacts. Where the time of
this library goes is in decisions 22, 23 and 27 (docs/decisions). MuJoCo and Drake are given bars and hinges, as rbdyn
is; MuJoCo closes loops by stiff springs, Drake has no loops in continuous time.
"""
    (ROOT / "docs" / "peers.md").write_text(text)


if __name__ == "__main__":
    main()
