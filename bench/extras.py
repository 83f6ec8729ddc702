"""Two questions of cost: tiles against points, and a background grid far larger than the body."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from coulter_post import Results
from problems import MPM, Scheme, boundary, ending, grid, listed, material

CELLS, STEPS, LARGER = 64, 5, 100


def block(scheme: Scheme, larger: int = 1) -> str:
    """A unit square between rollers off the grid, pressed by 2 %; the grid as large as asked."""
    h = 1.0 / CELLS
    reach = (CELLS + 4) * larger
    below = (reach - CELLS) // 2
    low = -(below + 0.37) * h
    push = f", displacement = {listed(0.0, -0.02)}"
    return (
        grid((low, low), h, (reach, reach))
        + material(1000.0, 0.3, 0.0, [(0, 0), (1, 0), (1, 1), (0, 1)], scheme)
        + boundary("base", "roller", [(0, 0), (1.02, 0)], scheme)
        + boundary("left", "roller", [(0, 1), (0, 0)], scheme)
        + boundary("top", "roller", [(1.02, 1), (0, 1)], scheme, push)
        + ending(STEPS, scheme)
    )


def cost(program: str, measured: Callable, text: str, folder: Path) -> dict:
    """Processor time and memory of a run, and microseconds per point and iteration.

    Phases are timed by the clock on the wall, so that the time of a phase is its share. The set-up
    of a step (and what begins and ends it, and the run) counts in `all`, not in `iteration`.
    """
    deck = folder / "block.nml"
    deck.write_text(text)
    usage, message = measured([program, "--quiet", "--output", folder, deck], 300, 1)
    if usage["code"] != 0:
        raise RuntimeError(message)
    results = Results(deck.with_suffix(".vtkhdf"))
    history = results.history
    seconds = history["phase_seconds"].sum(axis=0)
    share = dict(zip(results.phase_names, seconds / seconds.sum(), strict=True))
    n_points = len(results.frame(0).position)
    n_iterations = int(history["n_iterations"].sum())
    each = 1e6 * usage["cpu"] / n_points / n_iterations
    return {
        "points": n_points,
        "unknowns": int(history["n_dofs"][-1]),
        "iterations": n_iterations,
        "assembly": each * share["assemble"],
        "iteration": each * sum(share[phase] for phase in ("assemble", "factorise", "solve")),
        "all": each,
        "cpu": usage["cpu"],
        "memory": usage["memory"] / 1e6,
    }


def report(program: str, measured: Callable, repeat: int, folder: Path) -> None:
    """Print both tables as Markdown."""
    scenes = {
        f"{domains}, {label}": block(Scheme(points, control, bilateral=not control))
        for points, label in ((1, "1 point per cell"), (2, "2 x 2 points"))
        for domains, control in (("cpdi2", ""), ("mpm", MPM))
    }
    best: dict = {}
    for _ in range(repeat):  # in turns, so that all see the same noise
        for label, text in scenes.items():
            found = cost(program, measured, text, folder)
            if label not in best or found["cpu"] < best[label]["cpu"]:
                best[label] = found
    print(
        "| domains | points | unknowns | iterations | assembly (us) | without set-up (us) |"
        " with set-up (us) | all (s) |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for label, found in best.items():
        print(
            f"| {label} | {found['points']} | {found['unknowns']} | {found['iterations']} |"
            f" {found['assembly']:.2f} | {found['iteration']:.2f} | {found['all']:.2f} |"
            f" {found['cpu']:.3f} |"
        )
    for label in ("1 point per cell", "2 x 2 points"):
        tiles, points = best[f"cpdi2, {label}"], best[f"mpm, {label}"]
        ratios = [tiles[name] / points[name] for name in ("assembly", "iteration", "all", "cpu")]
        print(f"| cpdi2 over mpm, {label} | | | | " + " | ".join(f"{r:.2f}" for r in ratios) + " |")
    print("\n| cells of the grid | time (s) | memory (MB) |\n|---|---|---|")
    best = {}
    for _ in range(3 * repeat):
        for larger in (1, LARGER):
            found = cost(program, measured, block(Scheme(), larger), folder)
            if larger not in best or found["cpu"] < best[larger]["cpu"]:
                best[larger] = found
    for larger, found in best.items():
        cells = (CELLS + 4) * larger
        print(f"| {cells} x {cells} | {found['cpu']:.3f} | {found['memory']:.1f} |")
