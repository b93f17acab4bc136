"""Five lines to a first motion: a bead on a rough hoop."""

import rbdyn as rb

scene = rb.Scene(gravity=[0, 0, -9.81])
circle = rb.Circle(radius=0.5, start=[0, 0, -1], toward=[1, 0, 0])  # parameter 0 is the lowest point
hoop = rb.Rail(circle, friction=rb.Coulomb(mu_static=0.4, mu_dynamic=0.1))
bead = scene.add(rb.Particle(mass=0.5), hoop, parameter=0.0, speed=7.0)

run = rb.simulate(scene, until=6.0, error=1e-10)
print(run, *run.events, sep="\n")
run.plot("hoop.svg")

assert run[bead].speed(6.0) == 0.0  # it stays where it is, exactly
