"""Save, kill, continue: a process that saves as it goes is killed outright, and another one goes on from its file."""

import signal
import subprocess
import sys

import numpy as np
import pytest
import rbdyn as rb

UNTIL = 1e3

# as long as it lives it goes on by so many steps, and saves
PROGRAM = """
import sys
import rbdyn as rb

until, steps = float(sys.argv[1]), int(sys.argv[2])
run = rb.simulate(rb.load("top.json"), until=until, rtol=1e-11, max_steps=steps)
while run.status == "step limit":
    run.save("run.npz")
    print(run.end, flush=True)
    run = rb.simulate(run, until=until, max_steps=steps)
"""


def top():
    """A top whose moments all differ: it has no closed form."""
    scene = rb.Scene(gravity=[0, 0, -9.8125])
    body = rb.RigidBody(1.0, [0.2, 0.25, 0.1], com=[0, 0, 0.5])
    motion = {"attitude": rb.EulerAngles(0.5, 0.1, 0.2), "angular_velocity": [0, 0.5, 20.0]}
    top = scene.add(body, rb.Spherical(), name="top", **motion)
    scene.watch("upright", lambda now: now[top].angular_velocity[1])
    return scene


def killed_after(saves, folder):
    """Where the saves ended that a process told of before it was killed, as it computed or was at the next one."""
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(UNTIL), "1000"], stdout=subprocess.PIPE, text=True, cwd=folder
    )
    with process:
        ends = [float(process.stdout.readline()) for _ in range(saves)]
        process.kill()
        process.stdout.read()
    assert process.returncode == -signal.SIGKILL
    return ends


def state(run, t):
    motion = run["top"]
    return np.concatenate([motion.position(t), motion.velocity(t), motion.angular_velocity(t)])


@pytest.mark.parametrize("saves", [1, 4, 9])
def test_a_killed_run_goes_on_with_the_same_bits(saves, tmp_path):
    scene = top()
    rb.save(scene, tmp_path / "top.json")
    whole = rb.simulate(scene, until=UNTIL, rtol=1e-11)
    ends = killed_after(saves, tmp_path)
    left = rb.load(tmp_path / "run.npz")
    assert left.status == "step limit" and ends[-1] <= left.end < UNTIL
    on = rb.simulate(left, until=UNTIL, max_steps=10**6)
    assert on.start == left.end and on.end == UNTIL and on.status == "reached end"
    assert len(on.events) > 10
    assert [e.time for e in on.events] == [e.time for e in whole.events if e.time > on.start]
    for t in np.linspace(on.start, UNTIL, 9)[1:]:
        assert np.array_equal(state(on, t), state(whole, t))
