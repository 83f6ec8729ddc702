"""Command line: `python -m coulter_post figures|animate|summary|outline FILE`, `... point FILE...`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from . import figures, outline, samples
from .fields import FIELDS
from .results import Results


def main(arguments: list[str] | None = None) -> int:
    """Run a command; returns the exit status."""
    options = _parser().parse_args(arguments)
    try:
        options.command(options)
    except (KeyError, OSError, ValueError) as error:
        print(f"coulter_post: {error.args[0] if error.args else error}", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="coulter_post", description=__doc__)
    commands = parser.add_subparsers(required=True)

    draw = commands.add_parser("figures", help="draw frames, forces and convergence as PNG")
    draw.add_argument("file", type=Path, help="results file")
    draw.add_argument("--steps", type=int, nargs="+", help="load steps to draw, 0: initial state")
    draw.add_argument("--field", choices=sorted(FIELDS), default="ux", help="colour of the points")
    draw.add_argument("--output", type=Path, help="directory of the figures, default: of the file")
    draw.set_defaults(command=_draw)

    movie = commands.add_parser("animate", help="draw all frames as a GIF, or MP4 with ffmpeg")
    movie.add_argument("file", type=Path, help="results file")
    movie.add_argument("--field", choices=sorted(FIELDS), default="ux", help="colour of the points")
    movie.add_argument("--fps", type=float, default=8.0, help="frames per second")
    movie.add_argument("--output", type=Path, help="the film, default: NAME_FIELD.gif")
    movie.set_defaults(command=_animate)

    summary = commands.add_parser("summary", help="print a table of the steps")
    summary.add_argument("file", type=Path, help="results file")
    summary.set_defaults(
        command=lambda options: print("\n".join(_summary(Results(options.file))))
    )

    point = commands.add_parser("point", help="draw tests on samples (coulter point) as PNG")
    point.add_argument("files", type=Path, nargs="+", help="tables NAME_SAMPLE.csv, drawn together")
    point.add_argument("--output", type=Path, help="the figure, default: the first table's name")
    point.set_defaults(command=_draw_samples)

    drawing = commands.add_parser("outline", help="make the table of a tool from DXF or SVG")
    drawing.add_argument("file", type=Path, help="drawing")
    drawing.add_argument("-o", "--output", type=Path, help="the table, default: NAME.csv")
    drawing.add_argument("--layer", help="layer (DXF), or label or id of a group or shape (SVG)")
    drawing.add_argument("--number", type=int, help="which outline, if there are several")
    drawing.add_argument("--tolerance", type=float, help="largest distance between curve and chord,"
                         " default: a thousandth of the drawing")
    lengths = drawing.add_mutually_exclusive_group()
    lengths.add_argument("--unit", choices=outline.UNITS, help="unit of length of the table")
    lengths.add_argument("--scale", type=float, help="factor by which lengths are multiplied")
    drawing.set_defaults(command=_outline)
    return parser


def _outline(options: argparse.Namespace) -> None:
    scale = 1.0 if options.scale is None else options.scale
    if not scale > 0.0:
        raise ValueError("the scale must be > 0")
    tolerance = None if options.tolerance is None else options.tolerance / scale
    found = outline.read(options.file, options.layer, tolerance, options.unit)
    chosen = outline.choose(found, options.number, options.file)
    chosen.points *= scale
    path = options.output or options.file.with_suffix(".csv")
    path.parent.mkdir(parents=True, exist_ok=True)
    outline.write(chosen, path, options.file)
    shape = "polygon" if chosen.is_closed else "polyline"
    print(f"{path}: {chosen}; &tool shape = '{shape}', file = '{path.name}'")


def _draw_samples(options: argparse.Namespace) -> None:
    path = options.output or options.files[0].with_suffix(".png")
    path.parent.mkdir(parents=True, exist_ok=True)
    samples.draw([samples.Sample(file) for file in options.files]).savefig(path, dpi=150)
    print(path)


def _draw(options: argparse.Namespace) -> None:
    results = Results(options.file)
    directory = options.output or results.path.parent
    directory.mkdir(parents=True, exist_ok=True)
    drawn = {
        f"frames_{options.field}": figures.draw_frames(results, options.steps, options.field),
        "forces": figures.draw_forces(results),
        "tools": figures.draw_tools(results),
        "tractions": figures.draw_tractions(results, options.steps),
        "convergence": figures.draw_convergence(results),
    }
    for name, figure in drawn.items():
        if figure is not None:
            path = directory / f"{results.path.stem}_{name}.png"
            figure.savefig(path, dpi=150)
            print(path)


def _animate(options: argparse.Namespace) -> None:
    results = Results(options.file)
    path = options.output or results.path.with_name(f"{results.path.stem}_{options.field}.gif")
    path.parent.mkdir(parents=True, exist_ok=True)
    figures.animate(results, path, options.field, options.fps)
    print(path)


def _summary(results: Results) -> list[str]:
    history, provenance = results.history, results.provenance
    warnings: dict[int, list[str]] = {}
    for row, text in results.warnings:
        warnings.setdefault(row, []).append(text)
    names = results.boundary_names
    force = results.units.get("force", "")
    lines = [
        results.title,
        f"{provenance['status']}; {results.n_frames} frames,"
        f" {len(results.frame(0).position)} points, started {provenance['started']}",
        "",
        "force x, y of each boundary on the body" + (f" ({force})" if force else ""),
        f"{'step':>5} {'load':>6} {'iter':>5} {'residual':>9} {'seconds':>8}"
        + "".join(f"{name:>22}" for name in names),
    ]
    for row in range(len(history["step"])):
        residuals = history["residuals"][row]
        last = next((value for value in residuals[::-1] if np.isfinite(value)), np.nan)
        part = " " if history["is_complete"][row] else "+"
        lines.append(
            f"{history['step'][row]:>4}{part} {100.0 * history['load_factor'][row]:>4.0f} %"
            f" {history['n_iterations'][row]:>5} {last:>9.1e}"
            f" {history['phase_seconds'][row].sum():>8.2f}"
            + "".join(f"{x:>11.5g}{y:>11.5g}" for x, y in history["boundary_reactions"][row])
        )
        lines.extend(f"      warning: {text}" for text in warnings.get(row, []))
    return lines


if __name__ == "__main__":
    sys.exit(main())
