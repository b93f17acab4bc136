"""What accuracy costs: the price lists of eight scenes, and how well prices are predicted.

F: free body, 100 s. N: heavy body without symmetry, 5 s. hoop: a bead on a rough hoop, 6 s. belt: stick-slip, 60 s.
stiff: two masses, a soft spring and one 1e5 times as stiff with a damper, 5 s. chain: 100 masses joined by springs of
rest length, 1 s. ladder: it leaves its wall, 2 s. ball: it bounces to rest, 30 s.

predict: of random scenes a list is made, an error drawn, and what predict() says of it held against what its engine
takes at its tolerance, three times a scene, and against the error that has.
"""

import math
import sys
import time

import numpy as np
import rbdyn as rb
from scenes import DOWN, PRICED


def random_scene(random):
    """One of four kinds, with numbers of its own."""
    scene = rb.Scene(gravity=DOWN)
    kind = random.integers(4)
    if kind == 0:
        squares = random.uniform(0.5, 1.5, 3)  # sums of m x^2 along each axis, which any body has
        scene.add(
            rb.RigidBody(1.0, squares.sum() - squares, com=random.uniform(-0.3, 0.3, 3)),
            rb.Spherical(),
            angular_velocity=random.uniform(-5.0, 5.0, 3),
        )
    elif kind == 1:
        ball = scene.add(rb.Particle(random.uniform(0.5, 2.0)), position=[1, 0, 0], velocity=random.uniform(-1, 1, 3))
        scene.connect(rb.Spring(random.uniform(5.0, 50.0), rest_length=0.5), ball, [0, 0, 0])
        scene.apply(rb.Drag(quadratic=random.uniform(0.01, 0.1)), ball)
    elif kind == 2:
        circle = rb.Circle(radius=random.uniform(0.3, 2.0), start=[0, 0, -1], toward=[1, 0, 0])
        scene.add(rb.Particle(1.0), rb.Rail(circle), parameter=random.uniform(0.5, 2.5), speed=random.uniform(1.0, 9.0))
    else:
        rod = rb.shapes.rod(random.uniform(0.5, 2.0), 1.0, [0, 0, 1])
        upper = scene.add(rod, rb.Revolute([0, 1, 0], point=[0, 0, 0.5]), angle=random.uniform(0.5, 2.0))
        scene.add(
            rod, rb.Revolute([0, 1, 0], at=[0, 0, -0.5], point=[0, 0, 0.5]), parent=upper, angle=random.uniform(-1, 1)
        )
    return scene, 10.0


def predictions(count=200):
    """Ratios of what predicted prices and errors turn out to be, over what was said."""
    random = np.random.default_rng(18)
    prices, errors = [], []
    while len(prices) < 3 * count:
        scene, until = random_scene(random)
        price = rb.cost(scene, until, engines=["taylor", "dop853", "cvode-adams"], budget=3.0)
        # a double pendulum may swing so wildly that little can be had
        least = math.log10(min(row.error for row in price))
        for _ in range(3):
            error = 10.0 ** random.uniform(max(least, -10.0), -4.0)
            said = price.predict(error)
            # the same engine at that tolerance, and no other
            fresh = rb.cost(scene, until, errors=[said.tolerance], engines=[said.engine], budget=3.0)[0]
            prices.append(fresh.seconds / said.seconds)
            errors.append(fresh.error / error)
    return np.array(prices), np.array(errors)


def show_predictions():
    prices, errors = predictions()
    within = np.mean((prices < 1.5) & (prices > 1 / 1.5))
    print(f"predict: {prices.size} prices, {within:.0%} within 1.5 of what is then measured, ", end="")
    print(f"{prices.min():.2f} to {prices.max():.2f} of it, median {np.median(prices):.2f}")
    print(f"errors over those asked for: median {np.median(errors):.2g}, ", end="")
    print(f"{np.quantile(errors, 0.95):.2g} in 95 of 100, {errors.max():.2g} at most")


def main():
    for name in sys.argv[1:] or [*PRICED, "predict"]:
        if name == "predict":
            show_predictions()
            continue
        began = time.perf_counter()
        scene, until = PRICED[name]()
        price = rb.cost(scene, until)
        print(f"{name}, {until:g} s: made in {time.perf_counter() - began:.1f} s")
        print(price, end="\n\n")


if __name__ == "__main__":
    main()
