"""The list of hard cases, by subject: each row is held by at least one case, and each case stands in a row."""

from __future__ import annotations

from rbdyn.verification.case import CASES, Case

ROWS: dict[str, tuple[str, ...]] = {
    "Rotation": (
        "flips about the intermediate axis",
        "near the separatrix",
        "exactly on the intermediate axis",
        "stable axes over 1e6 turns",
        "symmetric body; nearly equal moments; sphere",
        "rod-like body, one moment 1e-12 or 0",
        "moments that violate rules",
        "theta -> 0 and pi in Euler angles",
        "top with cusps",
        "sleeping top at the threshold",
        "forced rigid body",
    ),
    "Friction and rails": (
        "Painleve's rod",
        "belt, m = k = v = 1, fs = 1, fd = .5",
        "fs much larger than fd, fs -> fd",
        "static hold below the cone for 1e6 s",
        "coasting on a frictional bend, no gravity",
        "N through zero; inflection with F_t = N = 0",
        "one-sided rail: leave a sphere, land again",
        "spline rail with a curvature jump",
        "Filippov sliding (two fields pointing at each other)",
    ),
    "Contact and events": (
        "bouncing ball restarted exactly on the plane",
        "Zeno ball",
        "simultaneous events",
        "backspin; disc beside tan a = 3 mu; sliding to rolling",
        "tippe top, rattleback, Euler's disk",
        "discs and ellipsoids on spheres and in bowls",
        "rocking, landing, ladders, cradles",
        "a contact redundant in its reactions",
        "several roots in one step",
        "grazing, 1e-12 either side",
        "event at t0, exactly at the end, at a saved time",
        "event after a reset; time events 1e-8 apart",
        "long steps: until = 1e6 s",
        "a guard that is NaN where a step begins",
        "a guard 1e-13 from its zero at the start",
        "NaN from a user's guard or force",
    ),
    "Systems and mechanisms": (
        "linkages over many turns; a walking linkage",
        "Bricard's mechanism: 30 rows of rank 29",
        "N-four-bar through its flat position",
        "a massless cross in a universal joint",
        "stiff governor; Andrews' mechanism",
        "double pendulum, chains, trees",
        "thin rods in trees and loops",
        "Kepler, e = 0.999 for 1000 turns; Pythagorean three bodies",
        "chain of 100,000 masses, the first one kicked",
        "mass ratio 1e8 along a chain",
    ),
    "Scale and length": (
        "1e6 periods of a pendulum",
        "mass ratios, stiff springs",
        "units from 1e-9 to 1e9",
    ),
    "Metamorphic checks": (
        "rotate or translate the world",
        "permute bodies",
        "mirror the world",
        "the same rigid body written as welded pieces",
        "time reversal",
        "stop and restart in the middle",
        "an effect with coefficient zero against none",
        "C++ against Python",
    ),
}


def cases_of(subject: str, row: str) -> list[Case]:
    """The cases of a row, in the order in which they are run."""
    return [case for case in CASES.values() if (case.subject, case.row) == (subject, row)]


def table() -> str:
    """The list as Markdown: row, cases, what is hard, the engines that hold each, where its answer comes from."""
    lines = []
    for subject, rows in ROWS.items():
        lines += [f"### {subject}", "| row | case | what is hard | held by | answer |", "|---|---|---|---|---|"]
        for row in rows:
            for case in cases_of(subject, row):
                held = ", ".join(case.holds) or "no engine needed"
                name = case.name if case.quick else f"{case.name} (full)"
                lines.append(f"| {row} | {name} | {case.hard} | {held} | {case.source} |")
        lines.append("")
    return "\n".join(lines)
