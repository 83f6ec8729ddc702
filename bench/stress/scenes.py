"""Scenes with known answers, as deck texts, and how far a result is from the answer.

Every scene is a pure function of its keywords and returns a `Scene`: the deck, the largest error
that the method owes (`bound`), and a function that measures the error of a results file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, exp, log, radians, sin, sqrt, tan

import h5py
import numpy as np

#: Largest error owed by tiling domains in scenes that they solve exactly, times a reserve: the
#: residual tolerance is 1e-8.
EXACT = 1.0e-6


@dataclass(frozen=True)
class Scene:
    """A deck, the error that its answer may have, and the measure of that error."""

    deck: str
    bound: float
    measure: Callable[[h5py.File], float]


def numbers(values) -> str:
    """Numbers as a deck wants them, with all digits."""
    return ", ".join(repr(float(value)) for value in np.ravel(values))


def group(kind: str, /, **variables) -> str:
    """One namelist group; None leaves a variable out."""
    lines = []
    for name, value in variables.items():
        if value is None:
            continue
        if isinstance(value, bool):
            text = ".true." if value else ".false."
        elif isinstance(value, Ints):
            text = str(value)
        elif isinstance(value, str):
            text = f"'{value}'"
        elif isinstance(value, int):
            text = str(value)
        else:
            text = numbers(value)
        lines.append(f"   {name} = {text}")
    return "\n".join([f"&{kind}", *lines, "/"])


def grid_around(corners, spacing: float, margin: int = 4, origin=None) -> str:
    """A grid that holds all corners with some cells to spare; one of its nodes is at `origin`."""
    origin = np.zeros(2) if origin is None else np.asarray(origin, float)
    first = np.floor((np.min(corners, axis=0) - origin) / spacing) - margin
    last = np.ceil((np.max(corners, axis=0) - origin) / spacing) + margin
    return group("grid", origin=origin + spacing * first, spacing=spacing,
                 cells=Ints(last - first))


class Ints(str):
    """A list of integers that `group` writes without quotes."""

    def __new__(cls, values):
        return super().__new__(cls, ", ".join(str(int(value)) for value in values))


def turn(degrees: float) -> np.ndarray:
    """Rotation matrix; right angles are exact."""
    if degrees % 90 == 0:
        c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][int(degrees // 90) % 4]
    else:
        c, s = cos(radians(degrees)), sin(radians(degrees))
    return np.array([[c, -s], [s, c]], float)


def last_state(file: h5py.File) -> dict[str, np.ndarray]:
    """Fields of the points in the last frame."""
    root = file["VTKHDF"]
    frame = int(root["Steps"].attrs["NSteps"]) - 1
    first = int(root["Steps/PointOffsets"][frame])
    rows = slice(first, first + int(root["NumberOfPoints"][frame]))
    return {name: data[rows] for name, data in root["PointData"].items()}


def stress_error(file: h5py.File, exact: np.ndarray, scale: float) -> float:
    """Root mean square error of the Cauchy stress in the plane over a stress."""
    state = last_state(file)
    stress = state["stress"][:, [0, 3, 3, 1]].reshape(-1, 2, 2)
    weight = state["volume"] / state["volume_ratio"]
    squares = np.sum((stress - exact) ** 2, axis=(1, 2))
    return float(np.sqrt(np.sum(weight * squares) / np.sum(weight)) / abs(scale))


def lame(modulus: float, nu: float) -> tuple[float, float]:
    """Lame's constants."""
    return modulus * nu / (1 + nu) / (1 - 2 * nu), modulus / 2 / (1 + nu)


def body_groups(corners, modulus, nu, density=0.0, ppc=None, initial_stress=None) -> list[str]:
    """Law, body and region of one polygon."""
    return [
        group("law", name="elastic", youngs_modulus=modulus, poisson_ratio=nu),
        group("body", name="block", law="elastic", density=density, points_per_cell=ppc,
              initial_stress=initial_stress),
        group("region", body="block", polygon=corners),
    ]


def control_group(domains=None, hourglass=None, ghost=None, small_cells=None, halvings=None,
                  fill=None) -> str:
    """Settings of the solution."""
    return group("control", domains=domains, hourglass=hourglass, ghost_penalty=ghost,
                 small_cells=small_cells, max_halvings=halvings, fill_tolerance=fill,
                 condition=True)


def patch(angle=15.0, h=0.125, stretch=0.9, steps=1, ppc=None, nu=0.3, modulus=1000.0,
          shift=(0.0137, 0.0231), size=1.0, length=1.0, far=(0.0, 0.0), band=None, domains=None,
          hourglass=None, ghost=None, small_cells=None, formulation=None, width=None,
          bilateral=None, joint=None, overlong=None, bound=None) -> Scene:
    """A block turned by `angle`, compressed along its own axis between frictionless plates.

    `shift` moves it against the grid, over h; `width` and `size` are its sides; all lengths are
    times `length`; `far` moves block and grid from the origin; at `joint`, a share of the width, the
    base is made of two segments.
    """
    width = size if width is None else width
    matrix, far = turn(angle), np.asarray(far, float) * length
    own = np.array([[0, 0], [width, 0], [width, size], [0, size]], float)
    place = lambda local: (np.asarray(local, float) @ matrix.T + np.array(shift) * h) * length + far
    corners = place(own)
    # walls that reach beyond what they hold cost accuracy without tiling domains
    overlong = domains != "mpm" if overlong is None else overlong
    slack = 0.4 * max(width, h) if overlong else 0.0
    common = dict(band_ratio=band, formulation=formulation, bilateral=bilateral)
    push = matrix @ [0.0, (stretch - 1.0) * size] * length
    deck = [
        grid_around(corners, h * length, origin=far),
        *body_groups(corners, modulus, nu, ppc=ppc),
        group("boundary", name="base", kind="roller", **common,
              vertices=place([[0, 0], *([[joint * width, 0]] if joint else []),
                              [width + slack, 0]])),
        group("boundary", name="side", kind="roller", **common,
              vertices=place([[0, size], [0, 0]])),
        group("boundary", name="top", kind="roller", **common, displacement=push,
              vertices=place([[width + slack, size], [0, size]])),
        group("steps", count=steps),
        control_group(domains, hourglass, ghost, small_cells),
    ]
    along = log(stretch)
    across = -nu / (1 - nu) * along
    value = modulus / (1 - nu**2) * along / exp(along + across)
    exact = matrix @ np.diag([0.0, value]) @ matrix.T
    if bound is None:
        # the implicit boundary method yields by a share of its band
        bound = EXACT if domains != "mpm" else max(
            1.0e-5, 2 * (band or 5.0e-6) * max(1.0, h / size, (1 - nu) / (1 - 2 * nu) / 2))
    return Scene("\n".join(deck), bound, lambda file: stress_error(file, exact, value))


def corner(opening=90.0, bisector=37.0, h=0.125, stretch=0.95, steps=1, ppc=None, nu=0.3,
           shift=(0.0137, 0.0231), domains=None, hourglass=None, ghost=None, bound=EXACT,
           modulus=1000.0) -> Scene:
    """A triangle between two walls that meet; a third wall pushes it into their corner.

    Shrinking about the corner leaves both walls where they are: the strain is the same everywhere
    and in all directions, whatever the angle.
    """
    half, side = radians(opening / 2), sqrt(1.0 / sin(radians(opening)))
    matrix = turn(bisector)
    place = lambda local: np.asarray(local, float) @ matrix.T + np.array(shift) * h
    low = side * np.array([cos(half), -sin(half)])
    high = side * np.array([cos(half), sin(half)])
    corners = place([[0, 0], low, high])
    push = matrix @ [(stretch - 1) * side * cos(half), 0.0]
    deck = [
        grid_around(corners, h),
        *body_groups(corners, modulus, nu, ppc=ppc),
        group("boundary", name="low", kind="roller", vertices=place([[0, 0], 1.2 * low])),
        group("boundary", name="high", kind="roller", vertices=place([1.2 * high, [0, 0]])),
        group("boundary", name="push", kind="roller", displacement=push,
              vertices=place([low + 0.2 * (low - high), high + 0.2 * (high - low)])),
        group("steps", count=steps),
        control_group(domains, hourglass, ghost),
    ]
    lam, mu = lame(modulus, nu)
    value = 2 * (lam + mu) * log(stretch) / stretch**2
    exact = value * np.eye(2)
    return Scene("\n".join(deck), bound, lambda file: stress_error(file, exact, value))


def lambert(s: float) -> float:
    """W(s): W exp(W) = s."""
    w = s / (1 + s) if s < 10 else log(s)
    for _ in range(60):
        w -= (w * exp(w) - s) / (exp(w) * (1 + w))
    return w


def column(load=0.08, cells=16, steps=8, nu=0.0, ppc=None, modulus=1.0e4, height=10.0, shift=0.0,
           domains=None, density=80.0, walls=False, hourglass=None, ghost=None, bound=0.02) -> Scene:
    """A column that settles under its own weight; `load` is its weight over the modulus."""
    lam, mu = lame(modulus, nu)
    confined, h = lam + 2 * mu, height / cells
    gravity = load * confined / density / height
    off = shift * h
    corners = np.array([[0, 0], [h, 0], [h, height], [0, height]], float)
    sides = [group("fixity", name=side, side=side, held="x") for side in ("left", "right")]
    base = [group("fixity", name="base", side="bottom", held="y")]
    grid = group("grid", origin=[0.0, 0.0], spacing=h, cells=Ints([1, cells + 2]))
    if walls:
        corners = corners * [4, 1] + off
        grid = grid_around(corners, h)
        x0, y0, x1, y1 = *corners[0], *corners[2]
        sides = [
            group("boundary", name="left", kind="roller", vertices=[x0, y1, x0, y0 - h]),
            group("boundary", name="right", kind="roller", vertices=[x1, y0 - h, x1, y1])]
        base = [group("boundary", name="base", kind="roller",
                      vertices=[x0 - h, y0, x1 + h, y0])]
    deck = [grid, *body_groups(corners, modulus, nu, density=density, ppc=ppc), *sides, *base,
            group("body_force", acceleration=[0.0, -gravity]), group("steps", count=steps),
            control_group(domains, hourglass, ghost)]

    def measure(file):
        state = last_state(file)
        frame = int(file["VTKHDF/Steps"].attrs["NSteps"]) - 1
        first = int(file["VTKHDF/Steps/PointOffsets"][frame])
        y = file["VTKHDF/Points"][first:first + len(state["volume"]), 1]
        y = y - state["displacement"][:, 1] - corners[0, 1]
        weight = state["volume"] / state["volume_ratio"]
        exact = -density * gravity * (height - y)
        error = np.sum(weight * abs(state["stress"][:, 1] - exact)) / np.sum(weight)
        # the settlement of the top is what people look at
        s = load
        w = lambert(s)
        length = height / s * (w + w * w / 2)
        top = np.argmax(y)
        share = (height - y[top]) / height * s
        wt = lambert(share)
        exact_y = length - height / s * (wt + wt * wt / 2)
        got = y[top] + state["displacement"][top, 1]
        settled = abs(got - exact_y) / (height - length)
        return float(max(error / (density * gravity * height), settled))

    return Scene("\n".join(deck), bound, measure)


def wedge(angle=20.0, h=2.0, steps=6, path=36.0, shift=(0.0, 0.0), reference=4521.0, bound=0.01,
          nu=0.3, ppc=None, hourglass=None, ghost=None, band=None, stretch_units=1.0) -> Scene:
    """Soil pushed up the wedge of input/wedge; the answer is the force on the pusher."""
    rise = tan(radians(angle))
    unit = stretch_units
    corners = np.array([[-20, 20 * rise], [0, 0], [120, 0], [120, 60], [-20, 60]]) * unit
    place = lambda vertices: np.asarray(vertices, float) * unit
    deck = [
        group("grid", origin=(np.array([-150.0, -4.0]) - np.array(shift) * h) * unit,
              spacing=h * unit, cells=Ints(np.ceil(np.array([280.0, 72.0]) / h))),
        *body_groups(corners, 1000.0, nu, ppc=ppc),
        group("boundary", name="floor", kind="roller", band_ratio=band,
              vertices=place([[0, 0], [120, 0]])),
        group("boundary", name="wedge", kind="roller", band_ratio=band,
              vertices=place([[-148, 148 * rise], [0, 0]])),
        group("boundary", name="top", kind="roller", band_ratio=band,
              vertices=place([[120, 60], [-148, 60]])),
        group("boundary", name="push", kind="roller", band_ratio=band,
              vertices=place([[120, 0], [120, 60]]), displacement=[-path * unit, 0.0]),
        group("steps", count=steps),
        control_group(None, hourglass, ghost),
    ]

    def measure(file):
        history = file["history"]
        rows = int(history.attrs["n_rows"])
        force = -history["boundary_reactions"][rows - 1, 3, 0]
        return float(abs(force / unit - reference) / reference)

    return Scene("\n".join(deck), bound, measure)


def carried(h=0.125, step=0.5, steps=8, ppc=None, domains=None, angle=0.0, size=0.5,
            shift=(0.0, 0.0), direction=(1.0, 0.0), modulus=1000.0) -> Scene:
    """A block carried along without strain by the plate it sticks to, `step` cells at a time."""
    matrix = turn(angle)
    place = lambda local: np.asarray(local, float) @ matrix.T * size + np.array(shift) * h
    corners = place([[0, 0], [1, 0], [1, 1], [0, 1]])
    path = np.asarray(direction) * step * steps * h
    deck = [
        grid_around(np.vstack([corners, corners + path]), h),
        *body_groups(corners, modulus, 0.3, ppc=ppc),
        group("boundary", name="plate", kind="prescribed", displacement=path,
              vertices=place([[0, 0], [1, 0]])),
        group("steps", count=steps), control_group(domains),
    ]

    def measure(file):
        state = last_state(file)
        moved = np.max(abs(state["displacement"][:, :2] - path)) / np.max(abs(path))
        return float(max(moved, np.max(abs(state["stress"])) / modulus))

    return Scene("\n".join(deck), EXACT, measure)


def unsupported(kind="nothing", domains=None) -> Scene:
    """A body that nothing holds as it should. Without weight it stays where it is or goes with the
    plate; with weight no answer exists, so every answer is wrong.
    """
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + 0.0137
    floor, top = 0.0137, 1.0137
    fall = group("body_force", acceleration=[0.0, -10.0])
    roller = dict(kind="roller", may_start_apart=True)
    parts = {
        "nothing": [],
        "weight alone": [fall],
        "weight, floor 0.5 h below": [fall, group(
            "boundary", name="floor", **roller,
            vertices=[-1.0, floor - 0.0625, 2.0, floor - 0.0625])],
        "weight, floor 10 h below": [fall, group(
            "boundary", name="floor", **roller, vertices=[-1.0, -1.25, 2.0, -1.25])],
        "plate moves away": [group(
            "boundary", name="plate", kind="roller", displacement=[0.0, 0.5],
            vertices=[2.0, top, -1.0, top])],
        "plate pushes, nothing behind": [group(
            "boundary", name="plate", kind="roller", displacement=[0.0, -0.5],
            vertices=[2.0, top, -1.0, top])],
        "held in x only, weight": [fall, group(
            "fixity", name="left", lower=[-0.1, -0.1], upper=[0.01, 2.0], held="x")],
        "held at one node, weight": [fall, group(
            "fixity", name="pin", lower=[-0.01, -0.01], upper=[0.01, 0.01], held="xy")],
    }
    deck = [grid_around(corners, 0.125, margin=12),
            *body_groups(corners, 1000.0, 0.3, density=1.0), *parts[kind],
            group("steps", count=2), control_group(domains)]
    moved = {"nothing": 0.0, "plate moves away": 0.0, "plate pushes, nothing behind": -0.5}

    def measure(file):
        exact = [0.0, moved.get(kind, np.inf)]
        return float(np.max(abs(last_state(file)["displacement"][:, :2] - exact)))

    return Scene("\n".join(deck), EXACT, measure)


def sliding(floor="bottom", domains=None) -> Scene:
    """A block that rests on a smooth floor under its weight: held upwards, free to slide."""
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + 0.0137
    deck = [grid_around(corners, 0.125), *body_groups(corners, 1000.0, 0.0, density=1.0),
            group("boundary", name="floor", kind="roller", vertices=[-1.0, 0.0137, 2.0, 0.0137]),
            group("body_force", acceleration=[0.0, -10.0]), group("steps", count=2),
            control_group(domains)]

    def measure(file):
        return float(np.max(abs(last_state(file)["displacement"][:, 0])))

    return Scene("\n".join(deck), 1.0e-6, measure)
