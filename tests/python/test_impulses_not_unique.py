"""Flat impacts of what slides on more feet than it needs: impulses are one choice of many, and where the motion depends
on which, a run says so. Against impulses that satisfy the same laws found by SciPy from other beginnings, in the plane
from every choice of what contacts do."""

import itertools
import math

import numpy as np
import pytest
import rbdyn as rb
from planar_scenes import gap_and_rows, random_scene
from scipy.optimize import least_squares

G, DROP, DOWN = 9.81, 0.1, -2.0
WHY = "the impulses of contacts that slide are not unique, and the motion depends on them"


class Plate:
    """A block on feet, dropped flat while it slides and turns about the vertical."""

    def __init__(self, feet, height, e, mu, slip, spin, com=(0.0, 0.0)):
        self.feet = np.c_[feet, np.full(len(feet), -height)]
        self.e, self.mu, self.spin, self.com = e, mu, spin, np.array([*com, 0.0])
        self.velocity = np.array([*slip, DOWN])
        self.inertia = np.array([0.4, 0.3, 0.6])

    def scene(self, turn=0.0, mirrored=False, hinge=False):
        c, s = math.cos(turn), math.sin(turn)
        frame = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]) @ np.diag([-1.0 if mirrored else 1.0, 1, 1])
        scene = rb.Scene(gravity=[0, 0, -G])
        inertia = frame @ np.diag(self.inertia) @ frame.T
        body = rb.RigidBody(1.0, 0.5 * (inertia + inertia.T), com=frame @ self.com)
        # of its origin, that the centre of mass has its velocity
        velocity = self.velocity - np.cross([0, 0, self.spin], self.com)
        block = scene.add(
            body,
            position=[0, 0, DROP - self.feet[0][2]],
            velocity=frame @ velocity,
            angular_velocity_world=[0, 0, -self.spin if mirrored else self.spin],
        )
        for foot in self.feet:
            scene.contact(
                block.point(frame @ foot), rb.Plane([0, 0, 1]), friction=rb.Coulomb(self.mu), restitution=self.e
            )
        if hinge:
            scene.add(
                rb.RigidBody(1.0, [1, 1, 1], com=[0, 0, -1]),
                rb.Revolute([0, 1, 0], at=[5, 5, 5], friction=rb.Coulomb(0.1), pin_radius=0.1),
            )
        return scene, block, frame

    def after(self, **options):
        """Velocity of the centre of mass and spin just after the impact, in axes that turn with the scene; or None."""
        scene, block, frame = self.scene(**options)
        time = (DOWN + math.sqrt(DOWN**2 + 2 * G * DROP)) / G
        try:
            run = rb.simulate(scene, until=time + 1e-3, error=1e-10)
        except rb.IntegrationError as error:
            assert WHY in str(error) and error.run.status == "inconsistent"
            assert error.run.end == pytest.approx(time, rel=1e-12)
            return None
        omega = run[block].angular_velocity_world(run.end)
        velocity = run[block].velocity(run.end) + np.cross(
            omega, run[block].rotation_matrix(run.end) @ frame @ self.com
        )
        spin = -omega[2] if options.get("mirrored") else omega[2]
        return np.array([*(frame.T @ velocity)[:2], spin])

    def choices(self, generator, count=24):
        """Velocities after it, of impulses that satisfy the laws, all feet sliding."""
        n, arms = len(self.feet), self.feet - self.com
        came = -math.sqrt(DOWN**2 + 2 * G * DROP)
        total = -(1 + self.e) * came
        # in the axes of the block, which has turned until then
        turned = self.spin * (DOWN - came) / G
        axes = np.array([[math.cos(turned), math.sin(turned)], [-math.sin(turned), math.cos(turned)]])
        before = axes @ self.velocity[:2]

        def laws(y):
            normal, (vx, vy, w) = y[:n], y[n:]
            u = np.c_[vx - w * arms[:, 1], vy + w * arms[:, 0]]
            push = np.c_[-self.mu * normal[:, None] * u / np.hypot(*u.T)[:, None], normal]
            change, turn = push.sum(0), np.cross(arms, push).sum(0) / self.inertia
            asked = [vx - before[0], vy - before[1], total, 0.0, 0.0, w - self.spin]
            return np.r_[change, turn] - asked

        found = []
        for _ in range(count):
            begin = np.r_[generator.dirichlet(np.ones(n)) * total, 0.7 * before, 0.7 * self.spin]
            low = np.r_[np.zeros(n), -np.full(3, np.inf)]
            begin[:n] = np.maximum(begin[:n], 1e-3)
            answer = least_squares(laws, begin, bounds=(low, np.inf), xtol=1e-15, ftol=1e-15, gtol=1e-15)
            y = answer.x
            slow = np.hypot(y[n] - y[n + 2] * arms[:, 1], y[n + 1] + y[n + 2] * arms[:, 0]).min()
            if np.abs(answer.fun).max() < 1e-11 and slow > 1e-6:
                found.append([*(axes.T @ y[n : n + 2]), y[n + 2]])
        return np.array(found).reshape(-1, 3)


def corners(a, b):
    return np.array([[p * a, q * b] for p in (-1, 1) for q in (-1, 1)])


def ring(n, generator):
    angles = generator.uniform(0, 2 * np.pi) + np.arange(n) * 2 * np.pi / n
    return np.c_[np.cos(angles), np.sin(angles)] * generator.uniform(0.4, 1)


def random_plate(seed, n):
    draw = np.random.default_rng(seed)
    feet = corners(*draw.uniform(0.3, 1, 2)) if n == 4 else ring(n, draw)
    return Plate(
        feet,
        draw.uniform(0.02, 0.25),
        float(draw.choice([0.5, 0.8, 1.0])),
        draw.uniform(0.05, 0.4),
        draw.normal(size=2) * 1.5,
        2 * draw.normal(),
    )


def same_in_all_axes(plate, told):
    for options in (
        {"turn": 0.7},
        {"turn": 1.2},
        {"turn": math.pi / 2},
        {"mirrored": True},
        {"mirrored": True, "turn": 0.3},
    ):
        other = plate.after(**options)
        assert (other is None) == (told is None), options
        if told is not None:
            np.testing.assert_allclose(other, told, rtol=0, atol=1e-12)


@pytest.mark.parametrize("n", [4, 5, 6])
def test_impulses_that_would_change_the_motion_end_a_run_in_all_axes(n):
    ended = went_on = 0
    for seed in range(4):
        plate = random_plate(seed, n)
        told = plate.after()
        same_in_all_axes(plate, told)
        choices = plate.choices(np.random.default_rng(seed))
        if told is None:
            ended += 1
            # two motions that satisfy the laws
            assert np.ptp(choices, axis=0).max() > 1e-9, seed
        else:
            went_on += 1
            # all that slide move alike; where impulses that stop it satisfy the laws as well it stops
            if len(choices) and np.abs(told).max() > 1e-12:
                np.testing.assert_allclose(choices, np.broadcast_to(told, choices.shape), rtol=0, atol=1e-8)
    assert ended >= 3


def test_three_feet_have_impulses_of_their_own():
    for seed in range(6):
        plate = random_plate(seed, 3)
        told = plate.after()
        assert told is not None
        same_in_all_axes(plate, told)
        for one in plate.choices(np.random.default_rng(seed), 4):
            np.testing.assert_allclose(one, told, rtol=0, atol=1e-8)


@pytest.mark.parametrize("n", [4, 5, 6])
def test_what_slides_without_a_spin_or_spins_on_its_place_goes_on(n):
    for seed in range(3):
        plate = random_plate(seed, n)
        plate.spin = 0.0
        told = plate.after()
        assert told is not None, seed
        same_in_all_axes(plate, told)
    # feet at one distance from the axis
    plate = random_plate(seed, n)
    plate.velocity[:2], plate.spin = 0.0, 4.0
    told = plate.after()
    assert told is not None and 0 < told[2] < 4.0
    same_in_all_axes(plate, told)


def test_friction_in_joints_elsewhere_makes_no_difference():
    plate = Plate(corners(0.7, 1.0), 0.175, 0.8, 0.3, (1.4, 0.0), -0.7)
    assert plate.after(hinge=True) is None
    plate.spin = 0.0
    np.testing.assert_allclose(plate.after(hinge=True), plate.after(), rtol=0, atol=1e-12)


def every_choice(normals, across, inverse, v, restitutions, coefficients):
    """All velocities that satisfy the laws of impact, from every choice of what contacts do: open, slide either way,
    stick. Newton's restitution and Coulomb's law for the impulses, as the library states them."""
    n = len(normals)
    rows = np.array([*normals, *across])
    w, u = rows @ inverse @ rows.T, rows @ v
    wanted = -np.array(restitutions) * np.minimum(u[:n], 0.0)
    for does in itertools.product(("open", 1, -1, "sticks"), repeat=n):
        a, b = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
        for k, one in enumerate(does):
            if one == "open":
                a[k, k] = a[n + k, n + k] = 1.0
                continue
            a[k], b[k] = w[k], wanted[k] - u[k]
            if one == "sticks":
                a[n + k], b[n + k] = w[n + k], -u[n + k]
            else:
                a[n + k, n + k], a[n + k, k] = 1.0, one * coefficients[k]
        impulse = np.linalg.lstsq(a, b, rcond=1e-11)[0]
        then = w @ impulse + u
        holds = abs(a @ impulse - b).max() < 1e-10
        for k, one in enumerate(does):
            if one == "open":
                holds &= then[k] >= wanted[k] - 1e-10
            else:
                holds &= impulse[k] >= -1e-10
                holds &= abs(impulse[n + k]) <= coefficients[k] * impulse[k] + 1e-10
                holds &= one == "sticks" or one * then[n + k] >= -1e-10
        if holds:
            yield v + inverse @ rows.T @ impulse


def velocities_after(planar, q, v):
    size = 3 * len(planar.bodies)
    inverse = np.diag([1 / one for b in planar.bodies for one in (b.mass, b.mass, b.moment)])
    normals, across, closed = [], [], []
    for contact in planar.contacts:
        gap, rows = gap_and_rows(planar, contact, q)
        if abs(gap) > 1e-10:
            continue
        both = np.zeros((2, size))
        for row, parts in zip(both, rows, strict=True):
            for body, *numbers in parts:
                row[3 * body : 3 * body + 3] += numbers
        normals.append(both[0])
        across.append(both[1])
        closed.append(contact)
    return list(every_choice(normals, across, inverse, v, [c.restitution for c in closed], [c.mu for c in closed]))


@pytest.mark.parametrize("seed", [156, 1781, 2132, 2218, 2225, 2553])
def test_in_the_plane_other_velocities_satisfy_the_laws_too(seed):
    planar = random_scene(seed, rough=True)
    scene, bodies, _ = planar.scene()
    with pytest.raises(rb.IntegrationError, match="are not unique|several velocities") as failure:
        rb.simulate(scene, 1.5, rtol=1e-12, max_steps=5000)
    run = failure.value.run
    q = [(*run[b].position(run.end)[:2], run[b].angle(run.end)) for b in bodies]
    v = np.concatenate([[*run[b].velocity(run.end)[:2], run[b].angular_velocity_world(run.end)[2]] for b in bodies])
    after = velocities_after(planar, q, v)
    apart = max(abs(one - other).max() for one in after for other in after)
    assert len(after) > 1 and apart > 1e-4 * abs(v).max()


class Thrown:
    """A body in a plane that strikes several planes at once, after a flight."""

    def __init__(self, points, normals, mu, e, velocity, mass=1.0, moment=0.25):
        self.points, self.normals = np.array(points, float), np.array(normals, float)
        self.normals /= np.linalg.norm(self.normals, axis=1)[:, None]
        self.mu, self.e = np.broadcast_to(mu, len(points)), np.broadcast_to(e, len(points))
        self.velocity = np.array(velocity, float)
        self.masses = np.array([mass, mass, moment])

    def velocities(self):
        """Those after it that satisfy the laws and gain no energy, no two alike."""
        both = list(zip(self.points, self.normals, strict=True))
        normals = [[*m, p[0] * m[1] - p[1] * m[0]] for p, m in both]
        across = [[m[1], -m[0], -p[0] * m[0] - p[1] * m[1]] for p, m in both]
        found = []
        for after in every_choice(normals, across, np.diag(1 / self.masses), self.velocity, self.e, self.mu):
            gains = after @ (self.masses * after) > self.velocity @ (self.masses * self.velocity) * (1 + 1e-10)
            if not gains and all(abs(after - one).max() > 1e-7 for one in found):
                found.append(after)
        return found

    def told(self, turn=0.0, mirrored=False, backwards=False, kicked=False):
        """The velocity after it, or why there is none."""
        c, s = math.cos(turn), math.sin(turn)
        axes = np.array([[c, -s], [s, c]]) @ np.diag([-1.0 if mirrored else 1.0, 1.0])
        sign, time = (-1.0 if mirrored else 1.0), 1 / 32
        scene = rb.Scene()
        velocity = axes @ self.velocity[:2]
        body = scene.add(
            rb.RigidBody(self.masses[0], [self.masses[2]] * 3),
            rb.Planar([1, 0, 0], [0, 1, 0]),
            **(
                {}
                if kicked
                else {
                    "position": -velocity * time,
                    "velocity": velocity,
                    "angle": -sign * self.velocity[2] * time,
                    "rate": sign * self.velocity[2],
                }
            ),
        )
        if kicked:
            to = {"velocity": velocity, "rate": sign * self.velocity[2]}
            scene.watch("kick", lambda now: now.time - time, action=lambda now: {body: to})
        order = range(len(self.points))
        for k in reversed(order) if backwards else order:
            place = axes @ self.points[k]
            scene.contact(
                body.point([*place, 0]),
                rb.Plane([*(axes @ self.normals[k]), 0], [*place, 0]),
                friction=rb.Coulomb(self.mu[k]),
                restitution=self.e[k],
            )
        try:
            run = rb.simulate(scene, time + 1e-6, error=1e-9)
        except rb.IntegrationError as error:
            return str(error)
        if any(e.note for e in run.events):
            return "lowered"
        struck = time if kicked else run.events[0].time
        return np.array([*(axes.T @ run[body].velocity(struck)[:2]), sign * run[body].angular_velocity(struck)[2]])


SEVERAL = "several velocities after the impact satisfy the laws"
BETWEEN_WALLS = [
    Thrown(
        [(-0.587967527890671, 0.766737646741565), (0.224408921116749, -0.429276824815925)],
        [(-0.49497429006813787, 0.8689076200445839), (0.2010350216160042, 0.9795840546292354)],
        1.0,
        1.0,
        (1.04989197682531, -0.15836697715077, -2.80518378865915),
        9.614341650971523,
        0.45268404208478563,
    ),
    Thrown(
        [
            (-0.6274752997134125, -0.244254340617613),
            (-0.98836083994059, -0.244254340617613),
            (0.945301387859, -0.244254340617613),
        ],
        [(0, 1)] * 3,
        [0.6, 2.0, 2.0],
        0.5,
        (1.3177444863155963, -0.5189796537380811, 0.0),
        4.488821505865516,
        0.23675956172760892,
    ),
]


@pytest.mark.parametrize("way", [{}, {"turn": 1.0}, {"mirrored": True}, {"backwards": True}], ids=str)
@pytest.mark.parametrize("thrown", BETWEEN_WALLS, ids=["two walls", "three feet"])
def test_what_sticks_or_slips_or_leaves_after_an_impact_by_choice_is_told(thrown, way):
    """One of two or three velocities was taken, and told to 2e-15."""
    after = thrown.velocities()
    assert len(after) > 1 and max(abs(a - b).max() for a in after for b in after) > 0.1
    assert SEVERAL in thrown.told(**way)


def test_impacts_go_on_where_the_laws_leave_one_velocity():
    """Random impacts of two and three points: of 150 a few have several velocities, and none of these is taken."""
    draw = np.random.default_rng(2027)
    one = several = 0
    for _ in range(150):
        n = int(draw.integers(2, 4))
        points = draw.uniform(-1, 1, (n, 2))
        angles = draw.uniform(-1.2, 1.2, n)
        normals = np.c_[np.sin(angles), np.cos(angles)]
        if n == 3:
            points[:, 1], normals = points[0, 1], np.array([[0, 1.0]] * 3)
        mass, moment = draw.uniform(0.3, 5), draw.uniform(0.05, 0.5)
        velocity = np.array([*draw.uniform(-2, 2, 2), draw.uniform(-2, 2) if n == 2 else 0.0])
        thrown = Thrown(
            points, normals, draw.uniform(0.3, 2.0, n), draw.choice([0.0, 0.5, 0.9, 1.0]), velocity, mass, moment
        )
        arrives = [
            velocity[:2] @ m + velocity[2] * (p[0] * m[1] - p[1] * m[0])
            for p, m in zip(thrown.points, thrown.normals, strict=True)
        ]
        if max(arrives) > -0.1:
            continue
        told, after = thrown.told(), thrown.velocities()
        if isinstance(told, str):
            assert told == "lowered" or len(after) != 1, (told, after)
            several += told != "lowered"
            continue
        one += 1
        assert len(after) == 1, (told, after)
        np.testing.assert_allclose(told, after[0], rtol=0, atol=1e-8 * abs(velocity).max())
    assert one > 15 and several > 0, (one, several)


# of each one velocity satisfies the laws and gains nothing; of the last two more gain energy
ONE_ONLY = [
    Thrown(
        [
            (0.027557309854549628, -0.972492518005065),
            (0.18874157184543683, -0.5577064758627386),
            (-0.8861535828711942, 0.11540380855664956),
        ],
        [(math.cos(a), math.sin(a)) for a in (2.901601282487287, 2.780045843729356, 2.730936220665658)],
        [0.5059652988404866, 0.6231308445957114, 0.46256270474901745],
        [0.8214995417411544, 0.15023806874535572, 0.1040550764176511],
        (0.9595143324683099, -0.35279577753876756, 0.3060081146649995),
        1.535759256318736,
        0.023572639182034092,
    ),
    Thrown(
        [
            (-0.19737340456307195, 0.6565232445827911),
            (0.9631494626478754, -0.519163256715206),
            (0.024946734954951477, 0.8507074235581491),
        ],
        [(math.cos(a), math.sin(a)) for a in (1.5220841286908728, 4.580126859649541, 1.671976091971596)],
        [0.18287166125583665, 0.9504622171679514, 1.609261461123219],
        [0.8321964779712999, 0.4693287623570024, 0.6880758889100972],
        (-0.6662428339936988, -0.3059474527580026, 1.6508651438696431),
        2.3016983564857036,
        6.883389456255358,
    ),
    Thrown(
        [(-0.9422502057929907, -0.9057493250257949), (0.6262609779257164, 0.8864426398822876)],
        [(math.cos(a), math.sin(a)) for a in (5.793917643692863, 1.3619569380379795)],
        [0.7194648506585078, 1.956882880542518],
        [0.8423567975328353, 0.7756310875309915],
        (-0.2803478026163997, -0.0635195230803978, -0.8674163147835753),
        2.1010750453574305,
        0.06566558525459006,
    ),
]


@pytest.mark.parametrize("kicked", [False, True])
@pytest.mark.parametrize("thrown", ONE_ONLY)
def test_one_velocity_that_gains_nothing_is_taken_as_it_is(thrown, kicked):
    """What parts again in all contacts is not struck once more, and restitution is lowered where no velocity gains
    nothing, not where another one would gain."""
    (after,) = thrown.velocities()
    told = thrown.told(kicked=kicked)
    assert not isinstance(told, str), told
    np.testing.assert_allclose(told, after, rtol=0, atol=1e-12)


def test_all_contacts_that_share_what_is_not_unique_are_named():
    """A table that slides while it turns: how its four feet share its weight changes the motion. One was named."""
    scene = rb.Scene(gravity=[0, 0, -9.81])
    table = scene.add(
        rb.RigidBody(2.0, [0.1, 0.12, 0.15]), position=[0, 0, 0.3], velocity=[1, 0.2, 0], angular_velocity=[0, 0, 2.0]
    )
    for x, y in ((0.4, 0.3), (-0.4, 0.3), (-0.4, -0.3), (0.4, -0.3)):
        scene.contact(table.point([x, y, -0.3]), rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.3))
    other = scene.add(rb.Particle(1.0), position=[5, 0, 0])
    scene.contact(other, rb.Plane([0, 0, 1]), friction=rb.Coulomb(0.3))
    with pytest.raises(rb.IntegrationError, match="of contact 1, contact 2, contact 3, contact 4[.]"):
        rb.simulate(scene, until=0.3)
