"""Cantilever held by an inclined wall in Kratos; see `beam` in problems.py."""

import math

import numpy as np
from kratos_common import Scene, arguments, constants, report, solve

ANGLE, LOAD, MODULUS, DEFLECTION = math.radians(30.0), 1000.0, 12.0e6, 0.48230


def turned(x: float, y: float) -> tuple[float, float]:
    """Rotation of a place about the origin."""
    c, s = math.cos(ANGLE), math.sin(ANGLE)
    return c * x - s * y, s * x + c * y


def main() -> None:
    """Solve and print the error of the mean deflection."""
    given = arguments()
    h = 1.0 / given.cells
    corners = np.array([turned(0, 1), turned(10, 0), turned(10, -1.5), turned(10, 1), (0, 0)])
    low = corners.min(axis=0) - 0.3 - h * np.array([0.41, 0.37])
    high = corners.max(axis=0) + 0.3 + h
    scene = Scene(*(np.arange(a, b, h) for a, b in zip(low, high, strict=True)))
    scene.wall("Wall", turned(0, 1), turned(0, 0), given.penalty * MODULUS / h, "fixed")
    law = constants(given.law, MODULUS, 0.2, 1.0, given.points)
    n = given.cells * given.finer
    scene.body(10 * n, n, lambda x, y: turned(10 * x, y), law)
    data = solve(scene, given.steps, turned(0, -LOAD))
    across = data["displacement"][:, :2] @ np.array(turned(0, -1))
    report(data, abs(float(np.average(across, weights=data["mass"])) / DEFLECTION - 1))


main()
