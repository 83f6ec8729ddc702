"""Wedge in Kratos; see `wedge` in problems.py. Floor and top are held grid nodes."""

import math

import numpy as np
from kratos_common import Scene, arguments, constants, report, solve

SLOPE, HEIGHT, LENGTH, PUSH, MODULUS = math.tan(math.radians(20.0)), 60.0, 120.0, 36.0, 1000.0
FORCE = 4518.0


def place(x: float, y: float) -> tuple[float, float]:
    """Body: above wedge and floor, below the top, 20 mm of it before the toe."""
    x = -20.0 + 140.0 * x
    low = max(0.0, -SLOPE * x)
    return x, low + y * (HEIGHT - low)


def main() -> None:
    """Solve and print the error of the push force, measured in a section behind the toe."""
    given = arguments()
    h = HEIGHT / given.cells
    xs = np.arange(-math.ceil(100.0 / h), math.ceil(124.0 / h) + 1) * h
    scene = Scene(xs, np.arange(given.cells + 1) * h)
    scene.hold("Floor", lambda x, y: y < 1e-9 and x > -1e-9, False, True)
    scene.hold("Lid", lambda x, y: y > HEIGHT - 1e-9, False, True)
    penalty = given.penalty * MODULUS / h
    scene.wall("Wedge", (0.0, 0.0), (-98.0, 98.0 * SLOPE), penalty)
    push = (-PUSH / given.steps, 0.0)
    scene.wall("Push", (LENGTH, 0.25 * h), (LENGTH, HEIGHT), penalty, increment=push)
    law = constants(given.law, MODULUS, 0.3, 1.0, given.points)
    n = given.cells * given.finer
    scene.body(round(140.0 / HEIGHT * n), n, place, law)
    data = solve(scene, given.steps)
    x, stress = data["coord"][:, 0], data["cauchy_stress_vector"][:, 0]
    section = (x > 40.0) & (x < 60.0)
    force = -float(np.sum(stress[section] * data["volume"][section])) / 20.0
    print("push force", force)
    report(data, abs(force / FORCE - 1))


main()
