"""Run time against error: Coulter's schemes and other programs on problems with known answers.

    python bench/run.py [--quick] [--cases column,patch] [--repeat 3]

Writes bench/results.csv and docs/images/accuracy_*.png; docs/accuracy.md explains them.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

BENCH = Path(__file__).resolve().parent
ROOT = BENCH.parent
sys.path[:0] = [str(BENCH), str(ROOT / "postproc")]

from coulter_post import Results  # noqa: E402

import extras  # noqa: E402
import figures  # noqa: E402
from problems import PROBLEMS, SCHEMES, Problem, Scheme  # noqa: E402

PROGRAM = os.environ.get("COULTER_PROGRAM", str(ROOT / "build/release/coulter"))
#: Python with Kratos' packages, if it is not this one.
KRATOS_PYTHON = os.environ.get("COULTER_KRATOS_PYTHON", sys.executable)


@dataclass(frozen=True)
class Peer:
    """A way of running Kratos: what its driver is told, on which grids."""

    key: str
    cells: tuple[int, ...]
    steps: int
    penalty: int = 100  #: times modulus over spacing
    points: int = 4  #: per element of the body
    finer: int = 1  #: elements of the body per cell and direction


#: Of the penalties 1 to 10000 and of 4 to 256 points per cell, a usual choice and the best ones.
KRATOS = {
    "column": [Peer("kratos", (4, 8, 16, 32, 64, 128), 40)],
    "patch": [
        Peer("kratos_100", (8, 16, 32), 1),
        Peer("kratos_64", (8, 16, 32, 64), 1, 1000, 16, 2),
    ],
    "beam": [
        Peer("kratos_100_16", (2, 4, 8), 5, 100, 16),
        Peer("kratos_10_64", (2, 4, 8), 5, 10, 16, 2),
    ],
    "wedge": [
        Peer("kratos_100", (10, 15, 20, 30), 6),
        Peer("kratos_10", (10, 15, 20, 30), 6, 10),
        Peer("kratos_100", (10, 15, 20), 36),
    ],
}
#: AMPLE 1.1 (GIMP, 2 x 2 points, 40 steps) on the column on grid lines, as published.
AMPLE = {4: 4.133e-2, 8: 1.294e-2, 16: 3.6589e-3, 32: 1.0487e-3, 64: 4.3572e-4}
#: Folder of AMPLE's functions, if it is there to be run by Octave.
AMPLE_FOLDER = os.environ.get("COULTER_AMPLE", "")
ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


@dataclass
class Run:
    """One row of results.csv; times in s, memory in bytes; without error, `note` says why."""

    problem: str
    scheme: str
    cells: int
    steps: int
    error: float | None = None
    user_s: float | None = None
    cpu_s: float | None = None
    memory: int | None = None
    iterations: int | None = None
    note: str = ""


def measured(command: list, seconds: int, repeat: int) -> tuple[dict, str]:
    """Cheapest of several runs of a command, fewer of long ones; and its messages."""
    if not Path(command[0]).is_file():
        raise SystemExit(f"{command[0]} is not there: build it, or set COULTER_PROGRAM")
    best: dict = {}
    starter = [sys.executable, "-I", "-S", BENCH / "measure.py", seconds]
    for k in range(repeat):
        done = subprocess.run(
            [str(part) for part in [*starter, *command]],
            env=ENVIRONMENT,
            capture_output=True,
            text=True,
            check=True,
        )
        usage = json.loads(done.stdout)
        if not best or usage["cpu"] < best["cpu"]:
            best = usage
        if usage["code"] != 0 or usage["cpu"] * (k + 1) > 4.0:
            break
    return best, done.stderr.strip()


def run_coulter(
    name: str,
    problem: Problem,
    key: str,
    scheme: Scheme,
    cells: int,
    steps: int,
    folder: Path,
    repeat: int,
) -> Run:
    """A deck, its run, its error."""
    deck = folder / f"{name}_{key}_{cells}_{steps}.nml"
    deck.write_text(problem.deck(cells, steps, scheme))
    run = Run(name, key, cells, steps)
    command = [PROGRAM, "--quiet", "--output", folder, deck]
    usage, message = measured(command, problem.longest, repeat)
    if usage["code"] != 0:
        run.note = message.splitlines()[0] if message else "stopped"
        return run
    results = Results(deck.with_suffix(".vtkhdf"))
    run.error = problem.error(results)
    run.iterations = int(results.history["n_iterations"].sum())
    run.user_s, run.cpu_s, run.memory = usage["user"], usage["cpu"], usage["memory"]
    return run


def coulter_runs(name: str, problem: Problem, folder: Path, quick: bool, repeat: int) -> Iterator:
    """All schemes, grids and numbers of steps of a problem."""
    for key in problem.schemes:
        numbers = [problem.steps]
        if key in ("default", "paper", "penalty") and not quick:
            numbers += problem.other_steps
        for steps in numbers:
            for cells in problem.cells[:2] if quick else problem.cells:
                yield run_coulter(
                    name, problem, key, SCHEMES[key], cells, steps, folder, repeat
                )


def has_kratos() -> bool:
    """Are Kratos and its applications installed?"""
    command = [KRATOS_PYTHON, "-c", "import KratosMultiphysics.MPMApplication"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def kratos_runs(name: str, folder: Path, quick: bool, repeat: int) -> Iterator[Run]:
    """Kratos on the same problem, on the same processor."""
    for peer in KRATOS.get(name, ()):
        for cells in peer.cells[: 1 if quick else None]:
            yield run_kratos(name, peer, cells, folder, repeat)


def run_kratos(name: str, peer: Peer, cells: int, folder: Path, repeat: int) -> Run:
    """Kratos on one grid."""
    told_driver = {
        "cells": cells,
        "steps": peer.steps,
        "penalty": peer.penalty,
        "points": peer.points,
        "finer": peer.finer,
    }
    options = [word for key, value in told_driver.items() for word in (f"--{key}", value)]
    command = [KRATOS_PYTHON, BENCH / f"peers/kratos_{name}.py", *options]
    return run_driver(Run(name, peer.key, cells, peer.steps), command, folder, repeat)


def ample_runs(name: str, folder: Path, quick: bool, repeat: int) -> Iterator[Run]:
    """AMPLE on the column, on the same processor."""
    if name != "column" or not AMPLE_FOLDER:
        return
    for cells in (4, 8) if quick else (4, 8, 16, 32):
        driver = ["octave-cli", "--no-gui", BENCH / "peers/ample_column.m", AMPLE_FOLDER]
        run = Run(name, "ample_octave", cells, 40)
        yield run_driver(run, [*driver, cells, run.steps], folder, repeat)


def run_driver(run: Run, command: list, folder: Path, repeat: int) -> Run:
    """Cheapest of several runs of a driver."""
    for k in range(repeat):
        try:
            done = subprocess.run(
                [str(part) for part in command],
                env={**ENVIRONMENT, "TMPDIR": str(folder)},
                capture_output=True,
                text=True,
                check=False,
                timeout=200,
            )
        except subprocess.TimeoutExpired:
            run.note = "stopped after 200 s"
            return run
        found = [line for line in done.stdout.splitlines() if line.startswith("RESULT")]
        if done.returncode != 0 or not found:
            known = "does not converge" in done.stderr
            run.note = done.stderr.strip().splitlines()[-1] if known else "stopped"
            return run
        result = json.loads(found[-1].removeprefix("RESULT"))
        if run.cpu_s is None or result["cpu"] < run.cpu_s:
            run.error, run.cpu_s, run.memory = result["error"], result["cpu"], result["memory"]
        if result["cpu"] * (k + 1) > 4.0:
            break
    return run


def published_runs(name: str) -> Iterator[Run]:
    """Errors that others have published; they come without times."""
    if name == "column":
        for cells, error in AMPLE.items():
            yield Run(name, "ample", cells, 40, error, note="published")


def keep(runs: list[Run], path: Path) -> None:
    """Write the table; rows of problems and schemes that were not run again stay."""
    fresh = {(run.problem, run.scheme) for run in runs}
    rows = [asdict(run) for run in runs]
    if path.is_file():
        with path.open(newline="") as file:
            kept = [r for r in csv.DictReader(file) if (r["problem"], r["scheme"]) not in fresh]
        rows = kept + rows
    order = list(PROBLEMS)
    rows.sort(key=lambda row: order.index(row["problem"]))
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(asdict(runs[0])), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({name: rounded(value) for name, value in row.items()})


def rounded(value: object) -> object:
    """Numbers with four digits."""
    return f"{value:.4g}" if isinstance(value, float) else value


def told(run: Run) -> str:
    """One line on the terminal."""
    head = f"{run.problem:12} {run.scheme:12} {run.cells:4} cells {run.steps:3} steps "
    if run.cpu_s is None:
        return head + (run.note if run.error is None else f"{run.error:10.2e}  {run.note}")
    return head + f"{run.error:10.2e} {run.cpu_s:9.3f} s {run.memory / 1e6:7.1f} MB"


def main(arguments: list[str] | None = None) -> None:
    """Run what was asked for, and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="two coarse grids, one run each")
    parser.add_argument("--cases", default=",".join(PROBLEMS), help="some of %(default)s")
    parser.add_argument("--repeat", type=int, default=3, help="runs of which the least counts")
    parser.add_argument("--results", type=Path, default=BENCH / "results.csv")
    parser.add_argument("--images", type=Path, default=ROOT / "docs/images")
    parser.add_argument("--no-peers", action="store_true", help="leave out other programs")
    parser.add_argument("--draw", action="store_true", help="draw the table; run nothing")
    parser.add_argument("--extras", action="store_true", help="cost per point, size of the grid")
    given = parser.parse_args(arguments)
    repeat = 1 if given.quick else given.repeat
    if given.extras:
        with tempfile.TemporaryDirectory(prefix="coulter_bench_") as folder:
            extras.report(PROGRAM, measured, repeat, Path(folder))
        return
    if not given.draw:
        peers = not given.no_peers and has_kratos()
        if not peers:
            print("other programs are left out")
        with tempfile.TemporaryDirectory(prefix="coulter_bench_") as folder:
            for name in given.cases.split(","):
                runs = []
                problem = PROBLEMS[name]
                for run in coulter_runs(name, problem, Path(folder), given.quick, repeat):
                    print(told(run), flush=True)
                    runs.append(run)
                for run in kratos_runs(name, Path(folder), given.quick, repeat) if peers else ():
                    print(told(run), flush=True)
                    runs.append(run)
                ample = () if given.no_peers else ample_runs(
                    name, Path(folder), given.quick, repeat
                )
                for run in ample:
                    print(told(run), flush=True)
                    runs.append(run)
                runs += published_runs(name)
                keep(runs, given.results)
    print(*figures.cheapest(given.results, 0.01), sep="\n")
    for path in figures.draw(given.results, given.images):
        print(path)


if __name__ == "__main__":
    main()
