"""A ball that bounces (e = 0.9, from 10 m, 20 s), beside Siconos and Simbody.

Siconos: event driven, and by Moreau's time stepping. Simbody: rigid contact by its semi-explicit time stepper, and its
compliant contact, whose motion is another one (beside/simbody_ball.cpp, built here). Siconos is asked for in Debian's
Python (python3-siconos), Simbody by its headers (libsimbody-dev), each in a process of its own; without them this says
so.
Milliseconds of processor time of the run, set-up left out, least of several; errors of place and velocity at the end,
each relative to its largest, against the sum of the bounces.
"""

import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

G, RESTITUTION, HEIGHT, UNTIL = 9.81, 0.9, 10.0, 20.0


def exact():
    speed = math.sqrt(2.0 * G * HEIGHT)
    t = speed / G
    while True:
        speed *= RESTITUTION
        if t + 2.0 * speed / G > UNTIL:
            since = UNTIL - t
            return speed * since - 0.5 * G * since**2, speed - G * since
        t += 2.0 * speed / G


def show(name, run, repeats, arguments=()):
    best = math.inf
    for _ in range(repeats):
        seconds, steps, place, velocity = run(*arguments)
        best = min(best, seconds)
    z, v = exact()
    error = max(abs(place - z) / HEIGHT, abs(velocity - v) / math.sqrt(2.0 * G * HEIGHT))
    print(f"| {name} | {steps} | {error:.1e} | {1e3 * best:.3g} |", flush=True)


def siconos_runs():
    # this file has the name of the package
    sys.path.pop(0)
    import numpy as np
    import siconos.kernel as sk

    def scene():
        ball = sk.LagrangianLinearTIDS(np.array([HEIGHT]), np.array([0.0]), np.array([[1.0]]))
        weight = np.array([-G])
        ball.setFExtPtr(weight)
        relation = sk.LagrangianLinearTIR(np.array([[1.0]]))
        model = sk.NonSmoothDynamicalSystem(0.0, UNTIL)
        model.insertDynamicalSystem(ball)
        model.link(sk.Interaction(sk.NewtonImpactNSL(RESTITUTION), relation), ball)
        return model, ball, weight

    def stepping(h):
        model, ball, _ = scene()
        run = sk.TimeStepping(model, sk.TimeDiscretisation(0.0, h), sk.MoreauJeanOSI(0.5), sk.LCP())
        begin, steps = time.thread_time(), 0
        while run.hasNextEvent():
            run.computeOneStep()
            run.nextStep()
            steps += 1
        return time.thread_time() - begin, steps, float(ball.q()[0]), float(ball.velocity()[0])

    def by_events():
        model, ball, _ = scene()
        run = sk.EventDriven(model, sk.TimeDiscretisation(0.0, 0.5))
        run.insertIntegrator(sk.LsodarOSI())
        run.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_IMPACT)
        run.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_SMOOTH_ACC)
        begin, steps = time.thread_time(), 0
        while run.hasNextEvent():
            run.advanceToEvent()
            run.processEvents()
            steps += 1
        return time.thread_time() - begin, steps, float(ball.q()[0]), float(ball.velocity()[0])

    show("Siconos, event driven (LSODAR)", by_events, 5)
    for h in (1e-3, 1e-4, 1e-5):
        show(f"Siconos, Moreau and Jean, steps of {h:g} s", lambda h=h: stepping(h), 1)


def library_runs():
    import rbdyn as rb

    scene = rb.Scene(gravity=[0, 0, -G])
    ball = scene.add(rb.Particle(1.0), position=[0, 0, HEIGHT])
    scene.contact(ball, rb.Plane([0, 0, 1]), restitution=RESTITUTION)
    rb.plan(scene)
    for how in ({"rtol": 1e-12}, {"error": 1e-12}):

        def run(how=how):
            begin = time.thread_time()
            made = rb.simulate(scene, UNTIL, keep="end", **how)
            seconds = time.thread_time() - begin
            return seconds, made.statistics.steps, made[ball].position(UNTIL)[2], made[ball].velocity(UNTIL)[2]

        (name, value) = next(iter(how.items()))
        show(f"rbdyn, {name}={value:g}", run, 20)


def simbody_runs():
    """Whether it could be built and run."""
    source = Path(__file__).parent / "beside" / "simbody_ball.cpp"
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "ball"
        libraries = ["-lSimTKsimbody", "-lSimTKmath", "-lSimTKcommon"]
        command = ["c++", "-O2", "-I/usr/include/simbody", str(source), "-o", str(program), *libraries]
        try:
            built = subprocess.run(command, capture_output=True)
        except OSError:
            return False
        if built.returncode != 0:
            return False
        # it tells of its own steps beside what is asked for
        lines = subprocess.run([program], capture_output=True, text=True).stdout.splitlines()
    for line in lines:
        if line.startswith("Simbody") and line.count(";") == 4:
            name, steps, place, velocity, seconds = line.split(";")
            show(name, lambda *r: r, 1, (float(seconds), int(steps), float(place), float(velocity)))
    return True


def main():
    if sys.argv[1:] == ["siconos"]:
        return siconos_runs()
    print("| | steps | error | time [ms] |\n|---|---|---|---|")
    library_runs()
    other = subprocess.run(["/usr/bin/python3", __file__, "siconos"], capture_output=True, text=True)
    print(other.stdout, end="")
    if other.returncode != 0:
        print("Siconos is not there: apt install python3-siconos")
    if not simbody_runs():
        print("Simbody is not there: apt install libsimbody-dev")


if __name__ == "__main__":
    main()
