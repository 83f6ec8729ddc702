"""Work-precision figures of results.csv: error against processor time and against memory."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from problems import PROBLEMS

mpl.use("Agg")

STYLE = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "lines.markersize": 4.5,
    "savefig.dpi": 150,
}
GRID_COLOUR = "#e2e5e8"
#: Label, colour, marker of a scheme or program; Coulter is filled, peers are hollow.
LOOKS = {
    "default": ("default: tiles, Nitsche, 1 point", "#0b5394", "o"),
    "default_2x2": ("tiles, Nitsche, 2 x 2 points", "#5fa8e0", "s"),
    "default_fbar": ("tiles with shared volumes, Nitsche, 2 x 2 points", "#7b68c8", "X"),
    "paper": ("mpm, implicit boundary of the paper", "#b45309", "^"),
    "penalty": ("mpm, penalty, delta = 0.05 h", "#d39b2a", "v"),
    "memory": ("mpm, penalty with memory", "#7a8f2a", "D"),
    "mpm_fbar": ("mpm with F-bar, penalty with memory", "#b9c26a", "d"),
    "gimp": ("gimp, penalty with memory", "#2f7d5b", "P"),
    "gimp_fbar": ("gimp with F-bar, penalty with memory", "#7fbf9f", "*"),
    "kratos": ("Kratos, 2 x 2 points", "#8b1e5b", "x"),
    "kratos_10": ("Kratos, 2 x 2 points, penalty 10 E/h", "#d16ba5", "+"),
    "kratos_100": ("Kratos, 2 x 2 points, penalty 100 E/h", "#8b1e5b", "x"),
    "kratos_100_16": ("Kratos, 4 x 4 points, penalty 100 E/h", "#8b1e5b", "x"),
    "kratos_64": ("Kratos, 8 x 8 points, penalty 1000 E/h", "#d16ba5", "+"),
    "kratos_10_64": ("Kratos, 8 x 8 points, penalty 10 E/h", "#d16ba5", "+"),
    "ample_octave": ("AMPLE in Octave, GIMP, 2 x 2 points", "#555555", "p"),
    "ample": ("AMPLE, GIMP: published error, no time", "#555555", ""),
}


def read(path: Path) -> list[dict]:
    """Rows that have an error."""
    with path.open(newline="") as file:
        return [row for row in csv.DictReader(file) if row["error"]]


def lines(rows: list[dict]) -> dict[tuple[str, int], list[dict]]:
    """Rows by scheme and number of steps, coarse grids first."""
    found: dict[tuple[str, int], list[dict]] = {}
    for row in sorted(rows, key=lambda row: int(row["cells"])):
        found.setdefault((row["scheme"], int(row["steps"])), []).append(row)
    order = list(LOOKS)
    return dict(sorted(found.items(), key=lambda item: (order.index(item[0][0]), item[0][1])))


def draw_panel(axes: Axes, rows: list[dict], usual_steps: int, cost: str, factor: float) -> None:
    """All lines of one problem."""
    axes.set(xscale="log", yscale="log")
    axes.grid(color=GRID_COLOUR, linewidth=0.6)
    axes.axhline(0.01, color="#9aa3ab", linewidth=0.8, linestyle=(0, (2, 2)), zorder=1)
    for (scheme, steps), line in lines(rows).items():
        label, colour, marker = LOOKS[scheme]
        if scheme == "ample":
            if cost == "cpu_s":
                draw_levels(axes, line, colour)
            continue
        dashed = steps != usual_steps
        axes.plot(
            [factor * float(row[cost]) for row in line],
            [float(row["error"]) for row in line],
            color=colour,
            marker=marker,
            linestyle="--" if dashed else "-",
            linewidth=1.0 if dashed or scheme.startswith(("kratos", "ample")) else 1.4,
            fillstyle="none" if dashed else "full",
            label=f"{label}, {steps} step{'s' if steps > 1 else ''}",
        )


def set_ticks(axis: Axis) -> None:
    """Plain numbers at the decades, and between them where there are few."""
    low, high = axis.get_view_interval()
    few = math.log10(high / low) < 2.5
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,), numticks=20))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def draw_levels(axes: Axes, line: list[dict], colour: str) -> None:
    """Errors without times, as marks at the right edge."""
    for row in line:
        error = float(row["error"])
        axes.annotate(
            f"AMPLE {row['cells']}",
            (1.0, error),
            xycoords=("axes fraction", "data"),
            xytext=(3, 0),
            textcoords="offset points",
            fontsize=6.5,
            color=colour,
            va="center",
        )
        axes.plot([0.985, 1.0], [error, error], color=colour, transform=axes.get_yaxis_transform())


def cheapest(table: Path, limit: float) -> list[str]:
    """Markdown: the first grid from which on every finer one has at most this error."""
    rows = ["| problem | scheme | steps | cells | error | time (s) |", "|---|---|---|---|---|---|"]
    for name, problem in PROBLEMS.items():
        of_problem = [row for row in read(table) if row["problem"] == name and row["cpu_s"]]
        for (scheme, steps), line in lines(of_problem).items():
            bad = [k for k, row in enumerate(line) if float(row["error"]) > limit]
            first = bad[-1] + 1 if bad else 0
            found = "never | | |"
            if first < len(line):
                row = line[first]
                percent, seconds = 100 * float(row["error"]), float(row["cpu_s"])
                found = f"{row['cells']} | {percent:.2g} % | {seconds:.2f} |"
            rows.append(f"| {problem.title} | {LOOKS[scheme][0]} | {steps} | {found}")
    return rows


def draw(table: Path, folder: Path) -> list[Path]:
    """One figure per problem: time on the left, memory on the right."""
    folder.mkdir(parents=True, exist_ok=True)
    paths, all_rows = [], read(table)
    for name, problem in PROBLEMS.items():
        rows = [row for row in all_rows if row["problem"] == name]
        if not rows:
            continue
        with mpl.rc_context(STYLE):
            figure = Figure(figsize=(9.6, 4.6), layout="constrained")
            left, right = figure.subplots(1, 2, sharey=True)
            draw_panel(left, rows, problem.steps, "cpu_s", 1.0)
            draw_panel(right, rows, problem.steps, "memory", 1e-6)
            for axis in (left.xaxis, left.yaxis, right.xaxis):
                set_ticks(axis)
            left.set(xlabel="processor time (s)", ylabel=problem.measure)
            right.set(xlabel="peak memory (MB)")
            figure.suptitle(problem.title, x=0.01, ha="left", fontsize=10.5)
            handles, labels = left.get_legend_handles_labels()
            figure.legend(
                handles, labels, loc="outside lower left", ncols=2, fontsize=8, handlelength=2.6
            )
            paths.append(folder / f"accuracy_{name}.png")
            figure.savefig(paths[-1])
    return paths
