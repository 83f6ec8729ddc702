"""Tools that go deep into clay: wedges against fields of slip lines, pipe and footing to two widths.

python bench/penetration.py [--only WORD] [--jobs N] [--keep FOLDER]

prints a table of docs/accuracy.md. Shear strength and widths are 1; half of each scene by symmetry.
"""

from __future__ import annotations

import argparse
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from math import acos, cos, pi, radians, sin, sqrt, tan
from pathlib import Path

import numpy as np
from run import PROGRAM, Results, measured


@dataclass
class Case:
    """A tool, how it rubs, how far it goes in how many steps, and the ground."""

    name: str
    tool: str
    shear: float
    depth: float
    spacing: float
    steps: int
    extent: tuple[float, float]
    semi_angle: float = 0.0
    poisson_ratio: float = 0.45
    law: str = "model = 'tresca', shear_strength = 1.0"
    modulus: float = 500.0


def wedge(semi_angle: float, shear: float, depth: float, spacing: float, extent: tuple) -> Case:
    """From the flat surface, ten steps for a cell."""
    law = f"model = 'von_mises', yield_stress = {sqrt(3.0)}"
    x, y = depth * tan(radians(semi_angle)) * 3.0, depth * 3.0
    tool = f"shape = 'polygon', vertices = 0.0, 0.0, {x}, {y}, {-x}, {y}"
    steps = round(10 * depth / spacing)
    name = f"wedge {semi_angle:g}, shear {shear:g}"
    return Case(
        name, tool, shear, depth, spacing, steps, extent, semi_angle, 0.49, law, 1000.0
    )


def pipe(shear: float, cells: int, per_cell: int = 5) -> Case:
    """Two diameters deep."""
    tool = "shape = 'circle', radius = 0.5, position = 0.0, 0.5"
    name = f"pipe, shear {shear:g}, {per_cell} steps a cell"
    return Case(name, tool, shear, 2.0, 1.0 / cells, 2 * cells * per_cell, (5.0, 5.0))


def footing(shear: float, cells: int, per_cell: int = 5) -> Case:
    """Two widths deep, with sides as high as it goes."""
    tool = "shape = 'rectangle', size = 1.0, 5.0"
    name = f"footing, shear {shear:g}, {per_cell} steps a cell"
    return Case(name, tool, shear, 2.0, 1.0 / cells, 2 * cells * per_cell, (5.0, 5.0))


CASES = [
    wedge(30, 0, 2.0, 0.2, (7, 5)),
    wedge(30, 1, 2.0, 0.2, (7, 5)),
    wedge(45, 0, 2.0, 0.4, (9.2, 6)),
    wedge(45, 0, 2.0, 0.2, (9, 6)),
    wedge(45, 0, 2.0, 0.1, (9, 6)),
    wedge(45, 0.5, 2.0, 0.2, (10, 6)),
    wedge(45, 1, 2.0, 0.2, (10, 6)),
    wedge(60, 0, 1.0, 0.1, (10, 6)),
    wedge(75, 0, 0.6, 0.1, (9, 5)),
    pipe(0, 8),
    pipe(0, 8, 10),
    pipe(0, 16),
    pipe(1, 8),
    pipe(1, 8, 10),
    pipe(1, 16),
    footing(0, 8),
    footing(1, 8),
    footing(1, 8, 10),
    footing(1, 16),
]


def deck(case: Case) -> str:
    """The scene as text."""
    h = case.spacing
    width, depth = case.extent
    cells = round(width / h) + 6, round((depth + 1.5 * case.depth) / h) + 6
    rubs = f", rough = .true., shear_limit = {case.shear}" if case.shear > 0 else ""
    return f"""&scene title = '{case.name}' /
&grid origin = {-2 * h}, {-depth - 2 * h}, spacing = {h}, cells = {cells[0]}, {cells[1]} /
&law name = 'clay', youngs_modulus = {case.modulus}, poisson_ratio = {case.poisson_ratio}, {case.law} /
&body name = 'bed', law = 'clay', density = 0.0 /
&region body = 'bed', rectangle = 0.0, {-depth}, {width}, 0.0 /
&boundary name = 'base', kind = 'fixed', vertices = -1.0, {-depth}, {width + 1.0}, {-depth} /
&boundary name = 'axis', kind = 'roller', bilateral = .true.
   vertices = 0.0, 9.0, 0.0, {-depth - 1.0} /
&boundary name = 'far side', kind = 'roller', bilateral = .true.
   vertices = {width}, {-depth - 1.0}, {width}, 9.0 /
&tool name = 'tool', {case.tool}, displacement = 0.0, {-case.depth} {rubs} /
&steps count = {case.steps} /
&output every = {case.steps} /
"""


def hill(semi_angle: float, shear: float) -> float:
    """Force on half a wedge over its depth (Hill, Lee, Tupper; Grunzweig, Longman, Petch)."""
    angle, eta = radians(semi_angle), 0.5 * acos(shear)
    low, high = 0.0, angle + 0.25 * pi - eta
    for _ in range(60):
        fan = 0.5 * (low + high)
        slope = 0.25 * pi + angle - eta - fan
        lip = sqrt(2.0) * cos(eta)
        down = cos(angle) - lip * sin(slope)
        above = lip * sin(slope) * (sin(angle) + lip * cos(slope) - down * tan(angle))
        low, high = (low, fan) if down**2 * tan(angle) > above else (fan, high)
    return ((1.0 + 2.0 * fan + sin(2.0 * eta)) * sin(angle) + shear * cos(angle)) / down


def judge(case: Case, history: dict[str, np.ndarray]) -> str:
    """What theory asks for beside what came out."""
    force = -history["boundary_reactions"][:, 3, 1]
    way = history["load_factor"] * case.depth
    if case.semi_angle > 0:
        # new tiles average the stress they find: the mean of the last third of the way
        part = np.diff(way, prepend=0.0)
        k = way > 2.0 / 3.0 * case.depth
        mean = np.sum((force / way * part)[k]) / np.sum(part[k])
        return f"force {mean / hill(case.semi_angle, case.shear):.3f}"
    places = [0.25, 0.5, 0.75, 1.0, 1.5, 2.0]
    means = [2.0 * force[abs(way - w) <= 0.06].mean() for w in places]
    return ", ".join(f"{m:.2f}" for m in means)


def row(case: Case, folder: Path) -> str:
    """Run one case: a line of the table."""
    path = folder / (case.name.replace(" ", "_").replace(",", "") + f"_{1 / case.spacing:g}.nml")
    path.write_text(deck(case))
    usage, message = measured([PROGRAM, "--quiet", "--output", folder, path], 3600, 1)
    if usage["code"] != 0:
        return f"| {case.name} | {case.spacing:g} | {message} | | | | | |"
    history = Results(path.with_suffix(".vtkhdf")).history
    n_iterations = history["n_iterations"]
    return (
        f"| {case.name} | {case.spacing:g} | {case.steps} ({len(n_iterations)})"
        f" | {n_iterations.mean():.1f} ({n_iterations.max()}) | {(history['has_retiled'] > 0).sum()}"
        f" | {history['penetrations'][:, 3].max() / case.spacing:.4f} | {usage['cpu']:.1f} | {judge(case, history)} |"
    )


def main() -> None:
    """Run what was asked for, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="cases whose name has this word")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder for decks and results")
    options = parser.parse_args()
    cases = [case for case in CASES if options.only in case.name]
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        print("| tool | h | steps (parts) | iterations (most) | resets | penetration/h | time (s) | result |")
        print("|---|---|---|---|---|---|---|---|")
        with ThreadPoolExecutor(options.jobs) as pool:
            for line in pool.map(lambda case: row(case, folder), cases):
                print(line, flush=True)


if __name__ == "__main__":
    main()
