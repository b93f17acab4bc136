"""Functions of any depth and chains of any length, on the call stack of a small thread: what nests is no recursion."""

import subprocess
import sys

import pytest

# in a process of its own: what overflows the stack ends it
IN_A_SMALL_THREAD = """
import pickle
import threading
import numpy as np
import rbdyn as rb

def main():
{}

threading.stack_size({} * 1024)
thread = threading.Thread(target=main)
thread.start()
thread.join()
"""


def printed_in_a_small_thread(code, kilobytes=512):
    indented = "\n".join("    " + line for line in code.strip().splitlines())
    done = subprocess.run(
        [sys.executable, "-c", IN_A_SMALL_THREAD.format(indented, kilobytes)],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


PUSHED = """
def force(x):
    for _ in range({count}):
        x = {step}
    return x
scene = rb.Scene()
body = scene.add(rb.Particle(1.0), position=[0.25, 0, 0])
scene.apply(rb.Force(lambda t, r, v: [force(r[0]), 0, 0]), body)
run = rb.simulate(scene, until=2.0**-20, rtol=1e-9)
print(float(run[body].acceleration(0.0)[0]), float(force(0.25)))
"""


@pytest.mark.parametrize(
    "step",
    [
        "np.sin(x) + 0.1",
        "x * 1.00001",
        "x + 0.001",
        "0.5 * x * x + 0.25",
        "1 / (1 + x * x)",
        "np.sqrt(1 + x * x) - 0.5",
        "np.tanh(x) + 0.1",
        "np.arctan2(x, 1.5)",
    ],
)
def test_a_force_of_nested_operations(step):
    recorded, plain = map(float, printed_in_a_small_thread(PUSHED.format(count=100_000, step=step)).split())
    assert abs(recorded - plain) <= 1e-9 * abs(plain)


def test_a_quotient_of_a_product_of_products():
    """Looked through once, not once by each way: y has 2^200 factors."""
    code = """
scene = rb.Scene()
body = scene.add(rb.Particle(1.0), position=[1, 0, 0])
def force(x):
    y = x + 0.0
    for _ in range(200):
        y = y * y
    return y / (2.0 * (x + 0.5))
scene.apply(rb.Force(lambda t, r, v: [force(r[0]), 0, 0]), body)
print(rb.simulate(scene, until=2.0**-300, rtol=1e-9)[body].acceleration(0.0)[0])
"""
    assert float(printed_in_a_small_thread(code)) == pytest.approx(1 / 3, rel=1e-12)


def test_a_chain_of_thousands_of_hinges():
    """Bodies of one kind that hang at rest on each other stay so."""
    code = """
scene, last = rb.Scene(gravity=[0, 0, -9.8125]), {}
rod = rb.shapes.rod(1.0, 1.0, [0, 0, 1])
for i in range(3000):
    hinge = rb.Revolute([0, 1, 0] if i % 2 else [1, 0, 0], at=[0, 0, -0.5 if i else 0.0], point=[0, 0, 0.5])
    last = {"parent": scene.add(rod, hinge, **last)}
print(rb.plan(scene).freedom)
"""
    assert printed_in_a_small_thread(code).split() == ["3000"]


JOINED = """
count = {count}
def force(t, r, v):
    condition = t < 1.0
    for k in range(count):
        condition = {step}
    return [np.where(condition, 1.0, -1.0), 0, 0]
plain = force({t}, None, None)[0]
scene = rb.Scene()
body = scene.add(rb.Particle(1.0))
scene.apply(rb.Force(force), body)
scene = pickle.loads(pickle.dumps(scene))
run = rb.simulate(scene, until={t} + 2.0**-20, start={t}, rtol=1e-9)
print(float(run[body].acceleration({t})[0]), float(plain))
"""


@pytest.mark.parametrize("t", [0.5, 1.5])
@pytest.mark.parametrize(
    "step",
    [
        "condition & (t < 2.0)",
        "(t < 2.0) & condition",
        "condition | (t > 2.0)",
        "condition ^ (t > 2.0)",
        "condition & (t < 2.0 + k)",
        "~condition",
    ],
)
def test_a_condition_of_thousands_of_comparisons(step, t):
    """Recorded, pickled, asked for and taken apart; one comparison may come again and again."""
    # each comparison that is another one is a guard
    count = 1000 if "+ k" in step else 20_000
    recorded, plain = map(float, printed_in_a_small_thread(JOINED.format(count=count, step=step, t=t)).split())
    assert recorded == plain
