"""Rotated patch in Kratos; see `patch` in problems.py. Exact for the law that is used."""

import math

import numpy as np
from kratos_common import Scene, arguments, constants, report, solve

ANGLE, STRETCH, MODULUS, RATIO = math.radians(30.0), 0.9, 1000.0, 0.3


def turned(x: float, y: float) -> tuple[float, float]:
    """Rotation of a place about the origin."""
    c, s = math.cos(ANGLE), math.sin(ANGLE)
    return c * x - s * y, s * x + c * y


def exact_stress(law: str) -> float:
    """Cauchy stress along a block whose sides are free, in plane strain."""
    if law == "hencky":
        along = math.log(STRETCH)
        across = -RATIO / (1 - RATIO) * along
        return MODULUS / (1 - RATIO**2) * along / math.exp(along + across)
    # neo-Hooke: J sigma = mu (lambda^2 - 1) + lame ln J, the stretch across by bisection
    lame = MODULUS * RATIO / ((1 + RATIO) * (1 - 2 * RATIO))
    shear = MODULUS / (2 * (1 + RATIO))
    low, high = 0.9, 1.2
    for _ in range(60):
        across = 0.5 * (low + high)
        pressed = shear * (across**2 - 1) + lame * math.log(across * STRETCH) > 0
        low, high = (low, across) if pressed else (across, high)
    jacobian = across * STRETCH
    return (shear * (STRETCH**2 - 1) + lame * math.log(jacobian)) / jacobian


def main() -> None:
    """Solve and print the error of the stress."""
    given = arguments()
    h = 1.0 / given.cells
    xs = np.arange(turned(0, 1)[0] - 0.1 - 0.41 * h, turned(1.2, 0)[0] + 0.1 + h, h)
    ys = np.arange(-0.1 - 0.37 * h, turned(1.2, 1)[1] + 0.1 + h, h)
    penalty = given.penalty * MODULUS / h
    scene = Scene(xs, ys)
    scene.wall("Base", turned(0, 0), turned(1, 0), penalty)
    # the side stops short of the corners, where averaged normals would make it hold them
    scene.wall("Side", turned(0, 1 - 3 * h), turned(0, 3 * h), penalty)
    push = turned(0, (STRETCH - 1) / given.steps)
    scene.wall("Top", turned(1, 1), turned(0, 1), penalty, increment=push)
    law = constants(given.law, MODULUS, RATIO, 1.0, given.points)
    n = given.cells * given.finer
    scene.body(n, n, turned, law)
    data = solve(scene, given.steps)
    exact = exact_stress(given.law)
    x, y = turned(0, 1)
    stress = data["cauchy_stress_vector"].T
    xx, yy, xy = stress[0], stress[1], stress[-1] if len(stress) == 3 else stress[3]
    wrong = (xx - exact * x * x) ** 2 + (yy - exact * y * y) ** 2 + 2 * (xy - exact * x * y) ** 2
    report(data, math.sqrt(np.average(wrong, weights=data["mass"])) / abs(exact))


main()
