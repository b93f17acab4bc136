"""Where a bead on a rough hoop comes to rest: two thousand starts at once, as one picture of its basins."""

import numpy as np
import numpy.typing as npt
import rbdyn as rb

scene = rb.Scene(gravity=[0, 0, -9.81])
hoop = rb.Rail(rb.Circle(0.5, start=[0, 0, -1], toward=[1, 0, 0]), friction=rb.Coulomb(0.4, 0.2))
bead = scene.add(rb.Particle(mass=0.1), hoop, name="bead")

angles, speeds = np.meshgrid(np.linspace(-3.0, 3.0, 61), np.linspace(-9.0, 9.0, 33))
many = rb.simulate_many(
    scene, {(bead, "parameter"): angles.ravel(), (bead, "speed"): speeds.ravel()}, until=20.0, error=1e-8
)
print(many)
assert not len(many.failed)

rest: npt.NDArray[np.float64] = many[bead].parameter(20.0).reshape(angles.shape)
turns = np.round(rest / (2 * np.pi)).astype(int)
print("\nturns until it sticks, over the angle it starts at (across) and its speed (down)")
for row, speed in zip(turns, speeds[:, 0], strict=True):
    print(f"{speed:6.2f} m/s  " + "".join("·" if n == 0 else str(abs(n)) for n in row))

# it sticks where static friction holds it: within the angle of friction of the lowest point, or of the highest
held = np.abs(rest - np.pi * np.round(rest / np.pi))
assert held.max() <= np.arctan(0.4) + 1e-9
assert np.all(many[bead].speed(20.0) == 0.0)
at_top = np.round(rest / np.pi).astype(int) % 2 == 1
print(f"\n{at_top.sum()} of them stay near the top; farthest from where it is level {held.max():.3f} rad,")
print(f"and the angle of static friction is {np.arctan(0.4):.3f} rad")
print(f"plans made for {len(many)} runs: {sum(s.planned for s in many.statistics)}")

# one of them by itself is the same, bit for bit
start = {(bead, "parameter"): angles[4, 7], (bead, "speed"): speeds[4, 7]}
alone = rb.simulate(scene, 20.0, error=1e-8, initial=start)
member = many[4 * 61 + 7]
assert alone.events == member.events and alone[bead].parameter(20.0) == member[bead].parameter(20.0)
