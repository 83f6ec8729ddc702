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


def cost(program: str, measured: Callable, repeat: int, text: str, folder: Path) -> dict:
    """The least disturbed of several runs: processor time, memory, microseconds per iteration.

    Phases are timed by the clock on the wall, so that the time of the assembly is its share.
    """
    deck = folder / "block.nml"
    deck.write_text(text)
    best: dict = {}
    for _ in range(repeat):
        usage, message = measured([program, "--quiet", "--output", folder, deck], 300, 1)
        if usage["code"] != 0:
            raise RuntimeError(message)
        results = Results(deck.with_suffix(".vtkhdf"))
        history = results.history
        seconds = history["phase_seconds"].sum(axis=0)
        if best and seconds.sum() > best["wall"]:
            continue
        n_points = len(results.frame(0).position)
        n_iterations = int(history["n_iterations"].sum())
        each = 1e6 * usage["cpu"] / n_points / n_iterations
        share = seconds[results.phase_names.index("assemble")] / seconds.sum()
        best = {
            "wall": seconds.sum(),
            "points": n_points,
            "unknowns": int(history["n_dofs"][-1]),
            "iterations": n_iterations,
            "assembly": each * share,
            "all": each,
            "cpu": usage["cpu"],
            "memory": usage["memory"] / 1e6,
        }
    return best


def report(program: str, measured: Callable, repeat: int, folder: Path) -> None:
    """Print both tables as Markdown."""
    print("| domains | points | unknowns | iterations | assembly (us) | all (us) | all (s) |")
    print("|---|---|---|---|---|---|---|")
    for label, control, points in (
        ("cpdi2, 1 point per cell", "", 1),
        ("mpm, 1 point per cell", MPM, 1),
        ("cpdi2, 2 x 2 points", "", 2),
        ("mpm, 2 x 2 points", MPM, 2),
    ):
        scheme = Scheme(points, control, bilateral=not control)
        text = block(scheme)
        found = cost(program, measured, repeat, text, folder)
        print(
            f"| {label} | {found['points']} | {found['unknowns']} | {found['iterations']} |"
            f" {found['assembly']:.2f} | {found['all']:.2f} | {found['cpu']:.3f} |"
        )
    print("\n| cells of the grid | time (s) | memory (MB) |\n|---|---|---|")
    best: dict[int, dict] = {}
    for _ in range(3 * repeat):  # in turns, so that both see the same noise
        for larger in (1, LARGER):
            found = cost(program, measured, 1, block(Scheme(), larger), folder)
            if larger not in best or found["cpu"] < best[larger]["cpu"]:
                best[larger] = found
    for larger, found in best.items():
        cells = (CELLS + 4) * larger
        print(f"| {cells} x {cells} | {found['cpu']:.3f} | {found['memory']:.1f} |")
