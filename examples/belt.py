"""Stick-slip on a conveyor that starts and stops: the drive of a rail as a function of time, written in NumPy."""

import numpy as np
import rbdyn as rb

scene = rb.Scene(gravity=[0, 0, -9.81])
belt = rb.Rail(
    rb.Line(direction=[1, 0, 0]),
    friction=rb.Coulomb(mu_static=0.6, mu_dynamic=0.4),
    drive=lambda t: 0.3 * np.sin(0.5 * t) ** 2,  # m/s
)
block = scene.add(rb.Particle(mass=2.0), belt, parameter=0.0, speed=0.0, name="block")
spring = scene.connect(rb.Spring(stiffness=80.0), block, [0, 0, 0])
print(rb.plan(scene))

run = rb.simulate(scene, until=20.0, error=1e-9)
print(run)
for event in run.events:
    print(f"{event.time:12.9f} s  {event.kind:<8} at x = {run[block].position(event.time)[0]:+.6f} m")

slips = run.events.times("slip", block)
print(f"{len(slips)} break-aways; the spring then pulls with", np.round(np.abs(run[spring].force(slips)[:, 0]), 6), "N")
assert np.allclose(np.abs(run[spring].force(slips)[:, 0]), 0.6 * 2.0 * 9.81, atol=2.0)  # the static limit, less m dV/dt
