"""Stress test of Coulter: sweeps of scenes with known answers far beyond what is sensible.

    python bench/stress/run.py [--only WORD] [--jobs N] [--program PATH]

The rule: no silent wrong answer. A run meets the bound of its scene, or it says why not: a warning,
or one message and an exit status other than zero. Writes bench/stress/results.csv and the tables of
docs/stability.md; ends with status 1 where the rule is broken.
"""

from __future__ import annotations

import argparse
import csv
import os
import resource
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from scenes import Scene  # noqa: E402
from sweeps import SWEEPS, Case  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
TABLE = ROOT / "bench/stress/results.csv"
PAGE = ROOT / "docs/stability.md"
BEGIN, END = "<!-- tables: bench/stress/run.py -->", "<!-- end of tables -->"
#: Seconds of processor time before a run is given up: others may keep the machine busy.
PATIENCE = 120
#: What must never be seen.
IMPOLITE = ("Backtrace", "runtime error", "Program received signal", "STOP", "forrtl")


@dataclass(frozen=True)
class Outcome:
    """How a run ended."""

    verdict: str  # right, warned, refused, failed, or the broken rules: wrong, crashed, endless
    status: int | None
    error: float
    iterations: int
    halvings: int
    condition: float
    remark: str

    @property
    def keeps_rule(self) -> bool:
        """Was the answer right, or the user told?"""
        return self.verdict in ("right", "warned", "refused", "failed")


def run_scene(scene: Scene, program: Path) -> Outcome:
    """Run a deck in a folder of its own and judge what comes out."""
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder) / "scene.nml"
        deck.write_text(scene.deck + "\n", encoding="utf-8")
        command = [str(program), "--output", folder, str(deck)]
        environment = dict(os.environ, OMP_NUM_THREADS="1")
        done = subprocess.run(command, capture_output=True, text=True, errors="replace",
                              check=False, env=environment, preexec_fn=limit_time)
        if done.returncode == -signal.SIGXCPU:
            return Outcome("endless", None, np.nan, 0, 0, np.nan, f"no end after {PATIENCE} s")
        return judge(scene, done, Path(folder) / "scene.vtkhdf")


def limit_time() -> None:
    """End this process when it has used up its time."""
    resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE + 5))


def judge(scene: Scene, done: subprocess.CompletedProcess, results: Path) -> Outcome:
    """Compare a run with the rule."""
    message = done.stderr.strip()
    if done.returncode != 0:
        polite = message and not any(word in done.stdout + message for word in IMPOLITE)
        verdict = {1: "failed", 2: "refused"}.get(done.returncode, "crashed") if polite else "crashed"
        return Outcome(verdict, done.returncode, np.nan, *effort(results), short(message))
    with h5py.File(results, "r", locking=False) as file:
        error = scene.measure(file)
    warning = warnings_of(done.stdout)
    if error <= scene.bound:
        verdict = "right"
    else:
        verdict = "warned" if warning else "wrong"
    return Outcome(verdict, 0, error, *effort(results), warning)


def effort(results: Path) -> tuple[int, int, float]:
    """Most iterations in a step, most halvings, and the worst condition of a step's last tangent."""
    if not results.is_file():
        return 0, 0, np.nan
    with h5py.File(results, "r", locking=False) as file:
        history = file["history"]
        rows = int(history.attrs["n_rows"])
        if rows == 0:
            return 0, 0, np.nan
        most = lambda name: max(history[name][:rows])
        return int(most("n_iterations")), int(most("n_halvings")), float(most("condition"))


def warnings_of(log: str) -> str:
    """First warning in a run log."""
    lines = log.splitlines()
    for i, line in enumerate(lines):
        if "warning: " in line:
            head, text = line.split("warning: ")
            indent = " " * len(head + "warning: ")
            rest = takewhile(lambda other: other.startswith(indent), lines[i + 1:])
            return short(" ".join([text, *rest]))
    return ""


def short(text: str) -> str:
    """First line without the path of the deck."""
    line = " ".join(text.split("\n")[0].split())
    for mark in ("scene.nml:", "coulter: "):
        line = line.split(mark)[-1]
    return line


def run_all(cases: list[Case], program: Path, jobs: int) -> list[Outcome]:
    """Outcomes in the order of the cases."""
    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(lambda case: run_scene(case.scene, program), cases))


def write_table(cases: list[Case], outcomes: list[Outcome]) -> None:
    """All outcomes as comma-separated values."""
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["sweep", "case", "verdict", "status", "error", "bound", "iterations",
                         "halvings", "condition", "remark"])
        for case, out in zip(cases, outcomes, strict=True):
            writer.writerow([case.sweep, case.name, out.verdict, out.status, f"{out.error:.1e}",
                             f"{case.scene.bound:.1e}", out.iterations, out.halvings,
                             f"{out.condition:.1e}", out.remark])


def summary(cases: list[Case], outcomes: list[Outcome]) -> str:
    """A table with a row per sweep and a list of what was not right."""
    lines = ["| sweep | runs | right | warned | failed | refused | broken | largest error |"
             " iterations | condition |", "|---|---|---|---|---|---|---|---|---|---|"]
    for sweep in dict.fromkeys(case.sweep for case in cases):
        own = [out for case, out in zip(cases, outcomes, strict=True) if case.sweep == sweep]
        count = lambda *words: sum(out.verdict in words for out in own)
        right = [out.error for out in own if out.verdict == "right"]
        worst = [out.condition for out in own if out.verdict == "right"]
        lines.append(
            f"| {sweep} | {len(own)} | {count('right')} | {count('warned')} | {count('failed')} |"
            f" {count('refused')} | {count('wrong', 'crashed', 'endless')} |"
            f" {f'{max(right):.0e}' if right else '-'} | {max(out.iterations for out in own)} |"
            f" {f'{max(worst):.0e}' if worst else '-'} |")
    lines += ["", "Not right, and how they ended:", "",
              "| sweep | case | ended | error | condition | remark |", "|---|---|---|---|---|---|"]
    for case, out in zip(cases, outcomes, strict=True):
        if out.verdict != "right":
            error, condition = ("-" if np.isnan(value) else f"{value:.0e}"
                                for value in (out.error, out.condition))
            lines.append(f"| {case.sweep} | {case.name} | {out.verdict} | {error} | {condition} |"
                         f" {out.remark} |")
    return "\n".join(lines)


def write_page(text: str) -> None:
    """Renew the tables between the two marks of the page."""
    page = PAGE.read_text(encoding="utf-8")
    head, rest = page.split(BEGIN)
    tail = rest.split(END)[1]
    PAGE.write_text(f"{head}{BEGIN}\n\n{text}\n\n{END}{tail}", encoding="utf-8")


def main() -> int:
    """Run the sweeps."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", default="", help="sweeps whose name holds this word; no files")
    parser.add_argument("--jobs", type=int, default=1, help="runs side by side")
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/coulter")
    options = parser.parse_args()
    cases = [case for case in SWEEPS if options.only in case.sweep]
    outcomes = run_all(cases, options.program.resolve(), options.jobs)
    for case, out in zip(cases, outcomes, strict=True):
        print(f"{case.sweep:24} {case.name:34} {out.verdict:8} {out.error:8.1e} "
              f"{out.iterations:3d} {out.halvings:2d} {out.condition:8.1e} {out.remark[:80]}")
    if not options.only:
        write_table(cases, outcomes)
        write_page(summary(cases, outcomes))
    broken = sum(not out.keeps_rule for out in outcomes)
    print(f"{len(cases)} runs, {broken} break the rule")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
