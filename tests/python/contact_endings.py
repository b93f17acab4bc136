"""How runs of random scenes with contacts end: python tests/python/contact_endings.py planar rough --scenes 10000

planar | space, smooth | rough. Each scene (planar_scenes.py, space_scenes.py) is run; told is how many ended in which
way, with the first seeds of each, and what is wrong in any of them:

    gap       a gap below -1e-12 of the size of what touches
    energy    a gain of more than 1e-11 of the largest energy
    cone      a force that pulls, or is out of its cone
    creep     what is at rest at the end has moved, by a single bit, 1e5 s later
    number    a gap, force or energy that is none
    time      no end within --limit seconds
    crash     the process has died

The exit code is 1 if anything is wrong.
"""

import argparse
import collections
import multiprocessing
import re
import sys
import time

import numpy as np
import rbdyn as rb
from planar_scenes import random_scene
from space_scenes import Space

UNTIL = 1.5
# of what touches, at least: radii and halves of sides
SIZE = 0.1
FAULTS = ("gap", "energy", "cone", "creep", "number", "time", "crash", "unnamed")


def built(kind, seed, rough):
    """A scene, its bodies, and its contacts: handle, static coefficient, and normal, None between two balls."""
    if kind == "space":
        space = Space(seed, rough=rough)
        return space.scene, space.bodies, space.contacts
    planar = random_scene(seed, rough=rough)
    scene, bodies, contacts = planar.scene()
    return (
        scene,
        bodies,
        [
            (contact, c.mu, None if c.other >= 0 else [*c.normal, 0])
            for contact, c in zip(contacts, planar.contacts, strict=True)
        ],
    )


def ending(why):
    """The class of a message: without times, numbers and names."""
    if not why:
        return "reached its end"
    why = re.sub(r"^simulate: ", "", why)
    why = re.sub(r"\bat t = \S+ s: ", ": ", why).replace(" :", ":")
    why = re.sub(r"(contact \d+)(, contact \d+)*", "contacts", why)
    return re.sub(r"-?\d+(\.\d+)?(e-?\d+)?", "#", why)[:120]


def faults_of(run, bodies, contacts, energies=61):
    """What is wrong in a run, by name."""
    if run.end == 0.0:
        return []
    t = np.linspace(0, run.end, energies)
    if run.status != "reached end":
        # where there is no motion any more a force may have a pole
        t = t[:-1]
    wrong = []
    energy = run.energy(t)
    numbers = [energy]
    if np.diff(energy).max() > 1e-11 * abs(energy).max():
        wrong.append("energy")
    for contact, mu, normal in contacts:
        gap, force = run[contact].gap(t), run[contact].force(t)
        numbers += [gap, force]
        if gap.min() < -1e-12 * SIZE:
            wrong.append("gap")
        if normal is None:
            continue
        pushes = force @ np.array(normal, float)
        across = np.linalg.norm(force - pushes[:, None] * normal, axis=1)
        size = max(1.0, abs(force).max())
        if pushes.min() < -1e-12 * size or (across > mu * pushes + 1e-9 * size).any():
            wrong.append("cone")
    if not all(np.isfinite(n).all() for n in numbers):
        wrong.append("number")
    return sorted(set(wrong))


def at_rest(run, bodies):
    return all(not run[b].velocity(run.end).any() and not run[b].angular_velocity(run.end).any() for b in bodies)


def outcome(kind, seed, rough, options):
    """How one scene ended, and its faults."""
    scene, bodies, contacts = built(kind, seed, rough)
    why = ""
    try:
        run = rb.simulate(scene, UNTIL, **options)
    except (rb.IntegrationError, rb.AccuracyError) as failure:
        run, why = failure.run, f"{type(failure).__name__}: {failure}"
    except rb.InvalidInput as refused:
        return f"refused: {ending(str(refused))}", []
    except Exception as fault:
        return f"{type(fault).__name__}: {ending(str(fault))}", ["unnamed"]
    wrong = faults_of(run, bodies, contacts)
    why = why or (run.status if run.status != "reached end" else "")
    if not why and at_rest(run, bodies):
        later = rb.simulate(scene, 1e5, **options)
        if any((later[b].position(1e5) != later[b].position(UNTIL)).any() for b in bodies):
            wrong.append("creep")
    return ending(why), wrong


def worker(pipe, kind, rough, options):
    while (seed := pipe.recv()) is not None:
        pipe.send(outcome(kind, seed, rough, options))


def outcomes(kind, seeds, rough, options, limit):
    """Of each seed, in a process of its own that is ended if it takes too long."""
    context = multiprocessing.get_context("spawn")

    def start():
        here, there = context.Pipe()
        process = context.Process(target=worker, args=(there, kind, rough, options), daemon=True)
        process.start()
        there.close()
        return here, process

    pipe, process = start()
    pipe.send(seeds[0])
    pipe.poll(60)
    pipe.recv()
    for seed in seeds:
        pipe.send(seed)
        try:
            if pipe.poll(limit):
                yield seed, pipe.recv()
                continue
            found = "took too long", ["time"]
        except EOFError:
            found = "crashed", ["crash"]
        process.kill()
        process.join()
        pipe, process = start()
        yield seed, found
    pipe.send(None)
    process.join()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["planar", "space"])
    parser.add_argument("law", choices=["smooth", "rough"])
    parser.add_argument("--scenes", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--error", type=float, help="asked for globally, instead of rtol=1e-12")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for a scene")
    parser.add_argument("--steps", type=int, default=5000, help="of a run at most")
    asked = parser.parse_args()
    options = {"error": asked.error} if asked.error else {"rtol": 1e-12}
    options["max_steps"] = asked.steps
    seeds = range(asked.first, asked.first + asked.scenes)
    began = time.monotonic()
    found, faults = collections.defaultdict(list), collections.defaultdict(list)
    for seed, (end, wrong) in outcomes(asked.kind, seeds, asked.law == "rough", options, asked.limit):
        found[end].append(seed)
        for one in wrong:
            faults[one].append(seed)
        if end != "reached its end" or wrong:
            print(seed, end, *wrong, file=sys.stderr, flush=True)
    print(f"{asked.kind} {asked.law}: {len(seeds)} scenes from {asked.first}, {time.monotonic() - began:.0f} s")
    for title, table in (("ended", found), ("wrong", faults)):
        for end, where in sorted(table.items(), key=lambda row: -len(row[1])):
            some = "" if end == "reached its end" else f"  ({', '.join(map(str, where[:6]))})"
            print(f"{title} {len(where):7d}  {end}{some}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
