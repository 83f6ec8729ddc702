"""Column under its own weight in Kratos; see `column_on_grid` in problems.py."""

import numpy as np
from kratos_common import Scene, arguments, constants, report, solve

HEIGHT, DENSITY, GRAVITY, MODULUS = 50.0, 80.0, 10.0, 1.0e4


def main() -> None:
    """Solve and print the error of the stress."""
    given = arguments()
    h = HEIGHT / given.cells
    scene = Scene(np.array([0.0, h]), np.arange(given.cells + 1) * h)
    scene.hold("Sides", lambda x, y: True, True, False)
    scene.hold("Base", lambda x, y: y == 0.0, False, True)
    law = constants(given.law, MODULUS, 0.0, DENSITY, given.points)
    scene.body(1, given.cells, lambda x, y: (x * h, y * HEIGHT), law)
    data = solve(scene, given.steps, (0.0, -GRAVITY))
    start = data["coord"][:, 1] - data["displacement"][:, 1]
    exact = -DENSITY * GRAVITY * (HEIGHT - start)
    wrong = np.abs(data["cauchy_stress_vector"][:, 1] - exact)
    weight = DENSITY * GRAVITY * HEIGHT
    report(data, float(np.average(wrong, weights=data["mass"])) / weight)


main()
