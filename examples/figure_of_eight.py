"""Three equal masses that chase each other along one curve, a figure of eight (Chenciner and Montgomery, 2000)."""

import numpy as np
import rbdyn as rb

scene = rb.Scene()
place, speed = np.array([0.97000436, -0.24308753, 0.0]), np.array([-0.93240737, -0.86473146, 0.0])
starts = [(place, -speed / 2), (-place, -speed / 2), (np.zeros(3), speed)]
bodies = [scene.add(rb.Particle(mass=1.0), position=r, velocity=v) for r, v in starts]
for i, a in enumerate(bodies):
    for b in bodies[:i]:
        scene.connect(rb.Gravitation(constant=1.0), b, a)

period = 6.32591398
run = rb.simulate(scene, until=10 * period, error=1e-11)
print(run)
for name, drift in run.drift.items():
    print(f"{name}: drift {drift:.1e}")

# each is where the next one was a third of a period before
t = np.linspace(period, 2 * period, 50)
apart = abs(run[bodies[0]].position(t) - run[bodies[2]].position(t - period / 3)).max()
apart = min(apart, abs(run[bodies[0]].position(t) - run[bodies[1]].position(t - period / 3)).max())
print(f"one follows the other within {apart:.0e} m")
assert apart < 1e-6

# both cardinal equations, about a pole that moves with one of the bodies, for the other two
first, second = run.cardinal_residuals(t, pole=bodies[0], of=bodies[1:])
assert abs(first).max() < 1e-12 and abs(second).max() < 1e-12
