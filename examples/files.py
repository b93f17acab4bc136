"""Nothing lost between sittings: a scene and a run as files, and the run going on another day."""

import os
import tempfile

import numpy as np
import rbdyn as rb

os.chdir(tempfile.mkdtemp())
top = rb.Scene(gravity=[0, 0, -9.81])
body = rb.RigidBody(1.0, [0.2, 0.25, 0.1], com=[0, 0, 0.5])  # no two moments are equal: no closed form
top.add(body, rb.Spherical(), attitude=rb.EulerAngles(0.5, 0, 0), angular_velocity=[0, 0.5, 20.0], name="top")
rb.save(top, "top.json")
rb.simulate(top, until=2.0, error=1e-9).save("monday.npz")

# on Tuesday, in another process
run: rb.Trajectory = rb.load("monday.npz")
on = rb.simulate(run, until=5.0)
scene: rb.Scene = rb.load("top.json")
whole = rb.simulate(scene, until=5.0, error=1e-9)
(top_of_run,), (top_of_whole,) = on.bodies, whole.bodies
apart = np.abs(on[top_of_run].rotation_matrix(5.0) - whole[top_of_whole].rotation_matrix(5.0)).max()
print(f"went on from {on.start} s to {on.end} s, estimated error {on.error:.1e}")
print(f"{apart:.1e} from the motion in one go, after {on[top_of_run].euler_angles(5.0)[2] / (2 * np.pi):.2f} turns")
assert apart < 4e-9 and on.error is not None and on.error <= 1e-9

on.sample(np.linspace(2.0, 5.0, 31)).to_csv("top.csv")
with open("top.csv") as file:
    names = file.readline().split(",")
print(f"top.csv has {len(names)} columns: {', '.join(names[:4])}, ...")
