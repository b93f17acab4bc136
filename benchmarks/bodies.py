"""Rigid bodies: what an error costs in time, beside heyoka, numbalsoda and SciPy where they are installed.

F: free body, I = (1, 2, 3), omega = (0.01, 1, 0.02), 100 s.
T: heavy symmetric top, I = (0.002, 0.002, 0.001) about the fixed point, m = 0.5, G at 0.05 on e3, g = 9.81, spin 300
   rad/s, tilt 0.3 rad, 10 s.
N: heavy body without symmetry, I = (0.0022, 0.0019, 0.001) about the fixed point, G = (0.01, 0.005, 0.05), the rest as
   T, 5 s.

Error: max(|d omega|/|omega|, |d q|) at the end. Time: the integration alone, no compilation, no plan, nothing kept but
the end. Each integrates the seven equations of omega and the quaternion; heyoka also T in the frame that follows the
axis without its spin, which the library chooses by itself. Tolerances by half powers of ten, from loose to tight; of
those that reach an error the quickest counts. The chosen runs then take turns; median and least of their times are
shown, and how many times as long the quickest of heyoka's takes at that error, by the least times, which a busy machine
does not spoil. The program of bodies.cpp, if given, adds the closed forms: set-up with one state, each further state.
"""

import math
import statistics
import subprocess
import sys
import time

import numpy as np
import rbdyn as rb
from scenes.euler_equations import euler_slopes

ERRORS = (1e-6, 1e-9, 1e-12)
TOLERANCES = [10.0 ** (-k / 2) for k in range(6, 34)]
TILT, MASS, GRAVITY = 0.3, 0.5, 9.81
SCENES = {  # moments, centre of mass, omega, tilt, until
    "F": ((1.0, 2.0, 3.0), None, (0.01, 1.0, 0.02), 0.0, 100.0),
    "T": ((0.002, 0.002, 0.001), (0.0, 0.0, 0.05), (0.0, 0.0, 300.0), TILT, 10.0),
    "N": ((0.0022, 0.0019, 0.001), (0.01, 0.005, 0.05), (0.0, 0.0, 300.0), TILT, 5.0),
}
# omega and the quaternion at the end: Taylor series of order 50 in 42 digits, of the same equations, in steps of 1.25
# and of 1 ms, which agree to all digits shown
END_OF_N = (
    "0.1880881974177066413217 "
    "-0.097208443913191538342 "
    "299.97243610055173399631 "
    "-0.764342467217968534421 "
    "-0.011666656534731932075 "
    "0.1491167471350671688580 "
    "0.6272229887817455709076 "
)


def start_of(name):
    _, _, omega, tilt, _ = SCENES[name]
    return [*omega, math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0]


def slopes(name, state):
    """Of the seven variables, for any numbers: Euler's equations (7.48) and those of the quaternion."""
    moments, center, _, _, _ = SCENES[name]
    return euler_slopes(moments, center and [MASS * GRAVITY * r for r in center], state)


def follow(state):
    """T in the frame that follows the axis: its spin is constant, and the frame does not turn about the axis."""
    (i1, _, i3), (_, _, arm), (_, _, spin), _, _ = SCENES["T"]
    w1, w2, a, b, c, d = state
    weight = MASS * GRAVITY * arm
    u1, u2 = 2.0 * (b * d - a * c), 2.0 * (c * d + a * b)
    return [
        (weight * u2 - i3 * spin * w2) / i1,
        (i3 * spin * w1 - weight * u1) / i1,
        -0.5 * (b * w1 + c * w2),
        0.5 * (a * w1 - d * w2),
        0.5 * (a * w2 + d * w1),
        0.5 * (b * w2 - c * w1),
    ]


def from_followed(state, until):
    """omega and the quaternion of the body: turned in the frame by the spin so far."""
    spin = SCENES["T"][2][2]
    s, c = math.sin(spin * until / 2), math.cos(spin * until / 2)
    w1, w2, w, x, y, z = state
    s2, c2 = math.sin(spin * until), math.cos(spin * until)
    return [c2 * w1 + s2 * w2, c2 * w2 - s2 * w1, spin, w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s]


def difference(state, exact):
    state, exact = np.asarray(state, float), np.asarray(exact, float)
    turn = min(np.linalg.norm(state[3:] - exact[3:]), np.linalg.norm(state[3:] + exact[3:]))
    return max(np.linalg.norm(state[:3] - exact[:3]) / np.linalg.norm(exact[:3]), turn)


# each: for a scene, functions of the tolerance that give (state at the end, seconds), by name


def scene_of(name):
    moments, center, omega, tilt, _ = SCENES[name]
    if center is None:
        scene = rb.Scene()
        return scene, scene.add(rb.RigidBody(1.0, moments), angular_velocity=omega)
    scene = rb.Scene(gravity=[0, 0, -GRAVITY])
    body = rb.RigidBody(MASS, moments, com=center, inertia_about="origin")
    attitude = rb.EulerAngles(theta=tilt, psi=0.0, phi=0.0)
    return scene, scene.add(body, rb.Spherical(), attitude=attitude, angular_velocity=omega)


def end_of(run, body):
    return [*run[body].angular_velocity(run.end), *run[body].quaternion(run.end)]


def library(name):
    scene, body = scene_of(name)
    until = SCENES[name][4]

    def with_engine(engine):
        def go(tolerance):
            run = rb.simulate(scene, until, rtol=max(tolerance, 1e-16), engine=engine, keep="end")
            return end_of(run, body), run.statistics.integration_seconds

        return go

    return {f"rbdyn, {engine}": with_engine(engine) for engine in ("taylor", "dop853")}


def with_heyoka(name):
    import heyoka

    until = SCENES[name][4]

    def made(equations, start, back):
        names = [f"x{i}" for i in range(len(start))]
        variables = [heyoka.make_vars(n) for n in names]
        system = list(zip(variables, equations(variables), strict=True))
        compiled = {}

        def go(tolerance):
            if tolerance not in compiled:
                compiled[tolerance] = heyoka.taylor_adaptive(system, start, tol=tolerance)
            integrator = compiled[tolerance]
            integrator.time = 0.0
            integrator.state[:] = start
            begin = time.perf_counter()
            integrator.propagate_until(until)
            return back(integrator.state), time.perf_counter() - begin

        return go

    runs = {"heyoka": made(lambda x: slopes(name, x), start_of(name), list)}
    if name == "T":
        start = start_of(name)
        runs["heyoka, axis followed"] = made(follow, [*start[:2], *start[3:]], lambda x: from_followed(x, until))
    return runs


def with_numbalsoda(name):
    import numba
    import numbalsoda

    until, start = SCENES[name][4], np.array(start_of(name))
    (i1, i2, i3), center, _, _, _ = SCENES[name]
    x, y, z = (MASS * GRAVITY * r for r in center or (0.0, 0.0, 0.0))
    heavy = center is not None

    @numba.cfunc(numbalsoda.lsoda_sig)
    def equations(t, s, out, _):
        w1, w2, w3, a, b, c, d = s[0], s[1], s[2], s[3], s[4], s[5], s[6]
        m1 = m2 = m3 = 0.0
        if heavy:
            u1, u2, u3 = 2.0 * (b * d - a * c), 2.0 * (c * d + a * b), a * a - b * b - c * c + d * d
            m1, m2, m3 = z * u2 - y * u3, x * u3 - z * u1, y * u1 - x * u2
        out[0] = ((i2 - i3) * w2 * w3 + m1) / i1
        out[1] = ((i3 - i1) * w3 * w1 + m2) / i2
        out[2] = ((i1 - i2) * w1 * w2 + m3) / i3
        out[3] = -0.5 * (b * w1 + c * w2 + d * w3)
        out[4] = 0.5 * (a * w1 + c * w3 - d * w2)
        out[5] = 0.5 * (a * w2 + d * w1 - b * w3)
        out[6] = 0.5 * (a * w3 + b * w2 - c * w1)

    times, address = np.array([0.0, until]), equations.address

    def go(tolerance):
        begin = time.perf_counter()
        states, ok = numbalsoda.dop853(address, start, times, rtol=tolerance, atol=tolerance, mxstep=10**7)
        return (states[-1] if ok else np.full(7, np.inf)), time.perf_counter() - begin

    return {"numbalsoda, dop853": go}


def with_scipy(name):
    from scipy.integrate import solve_ivp

    until, start = SCENES[name][4], start_of(name)

    def go(tolerance):
        begin = time.perf_counter()
        done = solve_ivp(
            lambda t, s: slopes(name, s.tolist()),
            (0.0, until),
            start,
            method="DOP853",
            rtol=max(tolerance, 3e-14),
            atol=tolerance,
            t_eval=[until],
        )
        return done.y[:, -1], time.perf_counter() - begin

    return {"SciPy, DOP853": go}


def calibrated(go, exact, tolerances):
    """For each error the tolerance that reaches it in the least time; those that none reaches are left out."""
    rows = []
    for tolerance in tolerances:
        state, seconds = go(tolerance)
        # one that takes long is not repeated to find which tolerance is the quickest
        seconds = min([seconds] + [go(tolerance)[1] for _ in range(9 if seconds < 0.02 else 0)])
        rows.append((difference(state, exact), seconds, tolerance))
        if rows[-1][0] <= ERRORS[-1]:
            break
    return {error: min(((s, tol, e) for e, s, tol in rows if e <= error), default=None) for error in ERRORS}


def exact_end(name):
    if name == "N":
        return [float(x) for x in END_OF_N.split()]
    scene, body = scene_of(name)
    run = rb.simulate(scene, SCENES[name][4], error=1e-14)
    assert run.engine == "closed form"
    return end_of(run, body)


def measured(goes, exact):
    """For each run by name and error: (tolerance, error reached, microseconds); None where it is not reached."""
    rows = {}
    for label, go in goes.items():
        # SciPy takes seconds
        steps = TOLERANCES[::2] if label.startswith("SciPy") else TOLERANCES
        for error, best in calibrated(go, exact, steps).items():
            rows[label, error] = best and (*best[1:], [])
    # all take turns; the slow ones a few times only
    for turn in range(101):
        for (label, _), row in rows.items():
            if row and (turn < 3 or sum(row[2]) < 1e6):
                row[2].append(goes[label](row[0])[1] * 1e6)
    return rows


def show(name, rows, closed):
    rival = {
        error: min(
            (min(r[2]) for (label, at), r in rows.items() if r and at == error and "heyoka" in label), default=None
        )
        for error in ERRORS
    }
    for (label, error), row in rows.items():
        head = f"{name:<6} {label:<22} {error:>6.0e}"
        if row is None:
            print(f"{head} {'not reached':>18}")
            continue
        tolerance, reached, times = row
        ratio = f"{rival[error] / min(times):10.3g}" if rival[error] else ""
        print(f"{head} {reached:>8.0e} {tolerance:>9.0e} {statistics.median(times):>11.1f} {min(times):>10.1f} {ratio}")
    if closed:
        setup, state = closed
        for error in ERRORS:
            ratio = f"{rival[error] / setup:10.3g}" if rival[error] else ""
            print(f"{name:<6} {'rbdyn, closed form':<22} {error:>6.0e} {'':>8} {'':>9} {'':>11} {setup:>10.1f} {ratio}")
        print(f"{name:<6} {'each further state':<22} {'':>36} {state:>10.2f}")


def main():
    closed = {}
    if len(sys.argv) > 1:
        for line in subprocess.run([sys.argv[1]], check=True, capture_output=True, text=True).stdout.splitlines():
            name, *values = line.split(";")
            closed[name] = [float(v) for v in values]
        print(f"calibration: {closed['calibration'][0]:.3f} us\n")
    print(
        f"{'scene':<29} {'error':>6} {'reached':>8} {'tolerance':>9} {'median [us]':>11} {'least':>10} {'heyoka':>10}"
    )
    missing = set()
    for name in SCENES:
        goes = {}
        for peer in (library, with_heyoka, with_numbalsoda, with_scipy):
            try:
                goes |= peer(name)
            except ImportError as reason:
                missing.add(reason.name)
        show(name, measured(goes, exact_end(name)), closed.get(name))
    for package in sorted(missing):
        print(f"{package} is not installed; pip install {package} brings it in")


if __name__ == "__main__":
    main()
