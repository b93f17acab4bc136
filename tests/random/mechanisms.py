"""The same mechanism told in another way moves alike: python tests/random/mechanisms.py [scenes] [seed].

Random trees and loops of 1 to 12 bodies with all joints, driven ones, springs, dampers and loads, told

* in another order (permuted: bodies, loads, couplings and constraints),
* from another place, turned, gravity with it (moved: all on a base that is fixed there),
* with a body as two that are welded (welded), and
* from another body (re-rooted: free trees).

Accelerations and reactions at the start, and places and velocities in the end, are compared over their largest; prints
what is more than rounding, and exits with the number of scenes of which something was.
"""

import sys
from dataclasses import dataclass, field, replace

import numpy as np
import rbdyn as rb

UNTIL, ERROR = 0.25, 1e-12
JOINTS = ["free", "spherical", "revolute", "prismatic", "universal", "cylindrical", "planar", "fixed", "rail"]
DRIVEN = ["turned", "pushed"]
TURNS = ("revolute", "cylindrical", "planar")


@dataclass
class Part:
    """A body and its joint; vectors in the parent's axes, those of the body's own in its."""

    kind: str
    parent: int
    mass: float
    center: np.ndarray
    inertia: np.ndarray  # about the centre of mass
    at: np.ndarray
    point: np.ndarray
    first: np.ndarray
    second: np.ndarray
    q: np.ndarray
    v: np.ndarray
    attitude: np.ndarray
    omega: np.ndarray
    acceleration: float = 0.0


@dataclass
class Mechanism:
    gravity: np.ndarray
    parts: list[Part] = field(default_factory=list)
    loads: list[tuple] = field(default_factory=list)
    springs: list[tuple] = field(default_factory=list)
    constraints: list[tuple] = field(default_factory=list)


def turning(axis, angle):
    """The matrix of a turn about a unit vector."""
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def direction(random):
    v = random.normal(size=3)
    return v / np.linalg.norm(v)


def random_turn(random):
    return turning(direction(random), random.uniform(-3, 3))


def random_part(random, parts, kinds):
    parents = [-1, *(i for i, p in enumerate(parts) if p.kind != "rail")]
    places = random.uniform(-1, 1, (5, 3))
    masses = random.uniform(0.25, 1.0, 5)
    center = masses @ places / masses.sum()
    arms = places - center
    inertia = sum(m * (a @ a * np.eye(3) - np.outer(a, a)) for m, a in zip(masses, arms, strict=True))
    first = direction(random)
    second = np.cross(first, direction(random))
    return Part(
        kind=str(random.choice(kinds)),
        parent=-1 if random.random() < 0.2 else int(random.choice(parents)),
        mass=masses.sum(),
        center=center,
        inertia=inertia,
        at=random.uniform(-1.5, 1.5, 3),
        point=random.uniform(-1, 1, 3),
        first=first,
        second=second / np.linalg.norm(second),
        q=random.uniform(-2, 2, 3),
        v=random.uniform(-3, 3, 3),
        attitude=random_turn(random),
        omega=random.uniform(-3, 3, 3),
        acceleration=random.uniform(-4, 4),
    )


def random_mechanism(random, *, loops, free=False):
    m = Mechanism(gravity=random.uniform(-8, 8, 3))
    count = int(random.integers(2 if free else 1, 7 if free else 13))
    kinds = [k for k in JOINTS if k != "rail"] if free else JOINTS + DRIVEN
    for i in range(count):
        part = random_part(random, m.parts, kinds)
        if free:
            part.kind = "free" if i == 0 else str(random.choice([k for k in kinds if k != "free"]))
            part.parent = i - 1
        m.parts.append(part)
    bodies = [i for i, p in enumerate(m.parts) if p.kind != "rail"]
    if not bodies:
        return random_mechanism(random, loops=loops, free=free)
    for _ in range(int(random.integers(0, count + 1))):
        body = int(random.choice(bodies))
        kind = str(random.choice(["force", "torque", "drag", "torsion", "joint"]))
        m.loads.append((kind, body, random.uniform(-5, 5, 3), random.uniform(-1, 1, 3), random.random() < 0.5))
    for _ in range(int(random.integers(0, count + 1))):
        a, b = int(random.choice(bodies)), int(random.choice([-1, *bodies]))
        if a != b and not (free and b < 0):
            m.springs.append((a, b, *random.uniform(-1, 1, (2, 3)), *random.uniform([1, 0, 0], [10, 1, 0.5])))
    for _ in range(int(random.integers(1, 3)) if loops else 0):
        a, b = int(random.choice(bodies)), int(random.choice([-1, *bodies]))
        if a != b:
            kind = str(random.choice(["ball", "rod", "plane", "hinge", "weld", "universal"]))
            m.constraints.append((kind, a, b, random.uniform(-1, 1, 3), direction(random), random.uniform(-1, 1, 3)))
    return m


def driven(part):
    q, v, a = float(part.q[0]), float(part.v[0]), part.acceleration
    return lambda t: q + t * (v + 0.5 * a * t)


def add_part(scene, part, parent, at):
    body = rb.RigidBody(part.mass, part.inertia, com=part.center)
    q, v, first = part.q, part.v, part.first
    where = {} if parent is None else {"parent": parent}
    hold = {"at": at, "point": part.point}
    match part.kind:
        case "free":
            start = {"position": at, "velocity": v, "attitude": part.attitude, "angular_velocity": part.omega}
            return scene.add(body, rb.Free(), **start, **where)
        case "spherical":
            return scene.add(body, rb.Spherical(**hold), attitude=part.attitude, angular_velocity=part.omega, **where)
        case "revolute":
            return scene.add(body, rb.Revolute(first, **hold), angle=q[0], rate=v[0], **where)
        case "prismatic":
            return scene.add(body, rb.Prismatic(first, **hold), displacement=q[0], rate=v[0], **where)
        case "universal":
            return scene.add(body, rb.Universal(first, part.second, **hold), angles=q[:2], rates=v[:2], **where)
        case "cylindrical":
            start = {"angle": q[0], "rate": v[0], "displacement": q[1], "displacement_rate": v[1]}
            return scene.add(body, rb.Cylindrical(first, **hold), **start, **where)
        case "planar":
            start = {"position": q[:2], "velocity": v[:2], "angle": q[2], "rate": v[2]}
            return scene.add(body, rb.Planar(first, part.second, at=at), **start, **where)
        case "fixed":
            return scene.add(body, rb.Fixed(attitude=part.attitude, **hold), **where)
        case "turned":
            return scene.add(body, rb.Revolute(first, motion=driven(part), **hold), **where)
        case "pushed":
            return scene.add(body, rb.Prismatic(first, motion=driven(part), **hold), **where)
    circle = rb.Circle(0.5 + abs(q[0]), first, part.second, at)
    return scene.add(rb.Particle(part.mass), rb.Rail(circle), parameter=q[1], speed=v[0], **where)


def add_load(scene, m, load, handles, turn):
    kind, body, value, point, in_body = load
    handle, joint, q, rate = handles[body], m.parts[body].kind, value[1], value[2]
    frame = {"frame": "body" if in_body else "world"}
    vector = value if in_body else turn @ value
    if kind == "force":
        scene.apply(rb.Force(vector, **frame), handle, at=point)
    elif kind == "torque":
        scene.apply(rb.Torque(vector, **frame), handle)
    elif kind == "drag":
        scene.apply(rb.Drag(linear=abs(value[0]), quadratic=abs(value[1])), handle, at=point)
    elif kind == "torsion" and joint in TURNS:
        scene.apply(rb.TorsionSpring(abs(value[0]), rest_angle=q, damping=abs(rate)), handle)
    elif kind == "joint" and joint in (*TURNS, "prismatic"):
        law = rb.JointForce if joint == "prismatic" else rb.JointTorque
        scene.apply(law(lambda t, x, u: value[0] * np.cos(x - q) - rate * u), handle)


def build(m, *, order=None, turn=None, moved=None, split=None, shuffled=None):
    """A scene, and the handles of the parts.

    `order` of adding; on a base that is `turn`ed and `moved`; `split`: a part of which three tenths are welded on.
    """
    turn = np.eye(3) if turn is None else turn
    moved = np.zeros(3) if moved is None else moved
    scene = rb.Scene(gravity=turn @ m.gravity)
    base = None
    if turn is not None and (moved.any() or (turn != np.eye(3)).any()):
        base = scene.add(rb.RigidBody(1.0, [1, 1, 1]), rb.Fixed(attitude=turn, at=moved))
    handles = {}
    for i in range(len(m.parts)) if order is None else order:
        part = m.parts[i]
        if split is not None and split[0] == i:
            _, attitude, at = split
            less = replace(part, mass=0.7 * part.mass, inertia=0.7 * part.inertia)
            handles[i] = add_part(scene, less, handles.get(part.parent, base), part.at)
            rest = attitude.T @ part.inertia @ attitude
            scene.add(
                rb.RigidBody(0.3 * part.mass, 0.15 * (rest + rest.T), com=attitude.T @ (part.center - at)),
                rb.Fixed(attitude=attitude, at=at),
                parent=handles[i],
            )
            continue
        handles[i] = add_part(scene, part, handles.get(part.parent, base), part.at)

    def end(body, point):
        if body >= 0:
            return handles[body].point(point)
        return point if base is None else base.point(point)

    things = [("load", x) for x in m.loads] + [("spring", x) for x in m.springs] + [("held", x) for x in m.constraints]
    if shuffled is not None:
        things = [things[k] for k in shuffled.permutation(len(things))]
    held = []
    if m.constraints:
        # where all starts, to close what is added there
        start = rb.simulate(scene, until=1e-9, rtol=1e-3)
        origin = {i: start[h].position(0.0) for i, h in handles.items()}
        axes = {
            i: start[h].rotation_matrix(0.0) if m.parts[i].kind != "rail" else np.eye(3) for i, h in handles.items()
        }
        origin[-1], axes[-1] = moved, turn
    for what, thing in things:
        if what == "load":
            add_load(scene, m, thing, handles, turn)
        elif what == "spring":
            a, b, at_a, at_b, stiffness, rest, damping = thing
            scene.connect(rb.Spring(stiffness, rest_length=rest, damping=damping), end(a, at_a), end(b, at_b))
        else:
            kind, a, b, at_a, axis, at_b = thing
            place = origin[a] + axes[a] @ at_a
            there = axes[b].T @ (place - origin[b])
            if kind == "ball":
                law = rb.Ball()
            elif kind == "rod":
                there = at_b
                law = rb.Rod(float(np.linalg.norm(place - origin[b] - axes[b] @ at_b)))
            elif kind == "plane":
                law = rb.PointOnPlane(rb.Plane(axis, there))
            elif kind == "hinge":
                law = rb.Hinge(axis)
            elif kind == "weld":
                law = rb.Weld()
            else:
                # at right angles in the world, and by their components
                second = np.cross(axis, axes[b].T @ axes[a] @ axis)
                if np.linalg.norm(second) < 0.1:
                    second = np.cross(axis, [0.6, 0.64, 0.48])
                law = rb.Universal(axis, second / np.linalg.norm(second))
            held.append((thing, scene.constrain(law, end(a, at_a), end(b, there))))
    if m.constraints:
        scene.assemble()
    return scene, handles, held


def reversed_joint(part):
    """The same joint told from the child: the child's child is what was its parent."""
    turn, zero = part.attitude, np.zeros(3)
    told = replace(part, at=part.point, point=part.at, q=-part.q, v=-part.v)
    if part.kind in ("spherical", "fixed"):
        return replace(told, attitude=turn.T, omega=-turn @ part.omega)
    if part.kind == "universal":
        return replace(told, first=part.second, second=part.first, q=-part.q[[1, 0, 2]], v=-part.v[[1, 0, 2]])
    if part.kind == "planar":
        normal = np.cross(part.first, part.second)
        angle, rate = part.q[2], part.v[2]
        place = part.q[:2] + np.array([part.at @ part.first, part.at @ part.second])
        back = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        across = np.array([[0.0, -1.0], [1.0, 0.0]])
        position, velocity = -back @ place, rate * across @ back @ place - back @ part.v[:2]
        return replace(
            told,
            at=-(part.at @ normal) * normal,
            point=zero,
            q=np.array([*position, -angle]),
            v=np.array([*velocity, -rate]),
        )
    return told


def re_rooted(m, run, handles):
    """A free chain told from its other end."""
    last = len(m.parts) - 1
    other = Mechanism(gravity=m.gravity)
    for i in range(last, -1, -1):
        own, joint = m.parts[i], m.parts[i] if i == last else reversed_joint(m.parts[i + 1])
        part = replace(joint, parent=last - i - 1, mass=own.mass, center=own.center, inertia=own.inertia)
        if i == last:
            now = run[handles[i]]
            part = replace(
                part,
                kind="free",
                at=now.position(0.0),
                v=now.velocity(0.0),
                attitude=now.rotation_matrix(0.0),
                omega=now.angular_velocity(0.0),
            )
        other.parts.append(part)
    other.springs = [(last - a, last - b, *rest) for a, b, *rest in m.springs]
    # loads along joints are of the body whose joint it is
    other.loads = [(kind, last - body, *rest) for kind, body, *rest in m.loads]
    return other


def seen(run, m, handles, joints, held, turn, moved):
    """Starts and ends of all, in the axes of the mechanism; `joints`: whose reactions, and on which side."""
    back = turn.T
    values = {"acceleration": [], "reaction": [], "held": [], "place": [], "velocity": [], "attitude": []}
    for i in sorted(handles):
        now, is_bead = run[handles[i]], m.parts[i].kind == "rail"
        if is_bead:
            values["acceleration"].append(back @ now.acceleration(0.0))
        else:
            values["acceleration"].append(back @ now.center_of_mass_acceleration(0.0))
            values["acceleration"].append(now.angular_acceleration(0.0))
            values["attitude"].append((back @ now.rotation_matrix(run.end)).ravel())
        values["place"].append(back @ (now.position(run.end) - moved))
        values["velocity"].append(back @ now.velocity(run.end))
    values["reaction"] = [side * (back @ run[handle].reaction(0.0)) for handle, side in joints]
    for _, handle in sorted(held, key=lambda h: next(k for k, c in enumerate(m.constraints) if c is h[0])):
        values["held"].append(back @ run[handle].force(0.0))
    return {k: np.concatenate(v) if v else np.zeros(0) for k, v in values.items()}


def differences(one, other):
    """Over the largest of each kind, forces together."""
    forces = max([1e-3, *(abs(one[k]).max() for k in ("reaction", "held") if len(one[k]))])
    result = {}
    for k, value in one.items():
        if not len(value):
            continue
        scale = forces if k in ("reaction", "held") else max(1.0, abs(value).max())
        result[k] = abs(value - other[k]).max() / scale
    return result


def stands_still(run, parts, handles, i):
    """Whether a body that its joint lets move does not."""
    if parts[i].kind in ("fixed", *DRIVEN, "rail"):
        return False
    now = run[handles[i]]
    if parts[i].parent >= 0 and parts[parts[i].parent].kind != "rail":
        before = run[handles[parts[i].parent]]
        turned = before.rotation_matrix(0.0).T @ now.rotation_matrix(0.0)
        after = before.rotation_matrix(run.end).T @ now.rotation_matrix(run.end)
        moved = [b.rotation_matrix(t).T for t, b in ((0.0, before), (run.end, before))]
        places = [a @ (now.position(t) - before.position(t)) for a, t in zip(moved, (0.0, run.end), strict=True)]
    else:
        turned, after = now.rotation_matrix(0.0), now.rotation_matrix(run.end)
        places = [now.position(0.0), now.position(run.end)]
    return abs(turned - after).max() < 1e-12 and abs(places[0] - places[1]).max() < 1e-12


def compare(seed, kind):
    """The largest differences of a scene told twice; None where there is nothing to compare, or a refusal."""
    random = np.random.default_rng([seed, 14])
    m = random_mechanism(random, loops=seed % 2 == 1 and kind != "re-rooted", free=kind == "re-rooted")
    count, turn, moved = len(m.parts), np.eye(3), np.zeros(3)
    try:
        scene, handles, held = build(m)
        run = rb.simulate(scene, until=UNTIL, error=ERROR, max_steps=2_000)
    except (rb.InvalidInput, rb.IntegrationError, rb.AccuracyError) as why:
        return str(why)
    if run.end < UNTIL:
        return "more steps than a quarter of a second should take"
    if any(stands_still(run, m.parts, handles, i) for i in range(count)):
        return "constraints leave a body no motion: what is left of its velocity is rounding"
    mapped = list(range(count))
    if kind == "permuted":
        left, order = list(range(count)), []
        while left:
            ready = [i for i in left if m.parts[i].parent not in left]
            order.append(int(random.choice(ready)))
            left.remove(order[-1])
        told = build(m, order=order, shuffled=random)
    elif kind == "moved":
        turn, moved = random_turn(random), random.uniform(-2, 2, 3)
        told = build(m, turn=turn, moved=moved)
    elif kind == "welded":
        bodies = [i for i, p in enumerate(m.parts) if p.kind != "rail"]
        told = build(m, split=(int(random.choice(bodies)), random_turn(random), random.uniform(-1, 1, 3)))
    else:
        m.loads = [load for load in m.loads if load[0] not in ("torsion", "joint")]
        scene, handles, held = build(m)
        run = rb.simulate(scene, until=UNTIL, error=ERROR, max_steps=2_000)
        mapped.reverse()
        told = build(re_rooted(m, run, handles))
    try:
        other = rb.simulate(told[0], until=UNTIL, error=ERROR, max_steps=2_000)
    except rb.AccuracyError as why:
        # within rounding of what can be told
        return str(why)
    except rb.IntegrationError as why:
        return {str(why): np.inf}
    theirs = {i: told[1][mapped[i]] for i in range(count)}
    joined = [i for i, p in enumerate(m.parts) if p.kind != "free"]
    # of a chain told from its other end each joint is of the body before
    sides = [(theirs[i - 1], -1.0) if kind == "re-rooted" else (theirs[i], 1.0) for i in joined]
    one = seen(run, m, handles, [(handles[i], 1.0) for i in joined], held, np.eye(3), np.zeros(3))
    return differences(one, seen(other, m, theirs, sides, told[2], turn, moved))


# at the start rounding of the scene itself; in the end the error asked for, and what doubles hold of a turned start
ALLOWED = {
    "acceleration": 1e-10,
    "reaction": 1e-10,
    "held": 1e-10,
    "place": 1e-11,
    "velocity": 1e-11,
    "attitude": 1e-11,
}
KINDS = ("permuted", "moved", "welded", "re-rooted")


def main(count=250, seed=0, quiet=False):
    wrong, done = [], 0
    for kind in KINDS:
        worst, refused = {}, 0
        for k in range(seed, seed + count):
            found = compare(k, kind)
            if isinstance(found, str):
                refused += 1
                if not quiet:
                    print(f"{kind} {k}: {found[:160]}")
                continue
            done += 1
            for what, value in found.items():
                worst[what] = max(worst.get(what, 0.0), value)
            if any(not value <= ALLOWED.get(what, 0.0) for what, value in found.items()):
                wrong.append((kind, k, found))
                if not quiet:
                    print(f"{kind} {k} is told otherwise: {found}")
        if not quiet:
            told = ", ".join(f"{what} {value:.1e}" for what, value in worst.items())
            print(f"{kind}: {count - refused} scenes, {refused} refused: {told}", flush=True)
    if not quiet:
        print(f"{done} told twice, {len(wrong)} of them otherwise")
    return done, wrong


if __name__ == "__main__":
    sys.exit(len(main(*map(int, sys.argv[1:]))[1]))
