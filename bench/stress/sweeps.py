"""The sweeps: which scenes with which numbers."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from scenes import Scene, carried, column, corner, patch, sliding, unsupported, wedge


@dataclass(frozen=True)
class Case:
    """One run of a sweep."""

    sweep: str
    name: str
    scene: Scene


def sweep(name, scene, variable, values, **fixed) -> list[Case]:
    """A scene with one variable at several values."""
    return [Case(name, f"{variable} {value}", scene(**{variable: value}, **fixed))
            for value in values]


def decades(first: int, last: int, step: int = 1) -> list[float]:
    """Powers of ten."""
    return [float(f"1e{k}") for k in range(first, last + 1, step)]


ANGLES = [0.0, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 5.0, 15.0, 30.0, 44.999999, 45.0, 60.0, 75.0, 89.0,
          89.999, 90.0 - 1e-6, 90.0 - 1e-9, 90.0]
BOTH = [("cpdi2", {}), ("mpm", {"domains": "mpm", "ppc": 2})]

#: What the implicit boundary method owes with walls longer than the body.
MPM_OVERLONG = 1.0e-2
#: What points as mere quadrature points owe when they cross cells (theory, section 2): little.
MPM_COLUMN = {"bound": 0.5}
MPM_STEPS = {"bound": 0.3}

SWEEPS: list[Case] = []
for _word, _domains in BOTH:
    SWEEPS += sweep(f"band, {_word}", patch, "band", decades(-12, 0),
                    **_domains | ({"formulation": "penalty"} if _domains else {}))
    SWEEPS += sweep(f"angle, {_word}", patch, "angle", ANGLES, **_domains)
    SWEEPS += sweep(f"angle on nodes, {_word}", patch, "angle", ANGLES, shift=(0.0, 0.0),
                    **_domains)
    # the block ends that far into the last cells
    SWEEPS += [Case(f"cut, {_word}", f"fraction {f}", patch(
        angle=0.0, size=1.0 + 0.125 * f, shift=(0.0, 0.0), **_domains))
        for f in [*decades(-12, -1), 0.05, 0.5, 0.9, 1.0 - 1e-6, 1.0]]
    SWEEPS += [Case(f"cut below, {_word}", f"fraction {f}", patch(
        angle=0.0, size=1.0, shift=(-f, -f), **_domains))
        for f in [*decades(-12, -1), 0.05, 0.5, 0.9, 1.0 - 1e-6]]
    SWEEPS += [Case(f"grid offset, {_word}", f"{f} h at {a} degrees", patch(
        angle=a, shift=(f, f), **_domains))
        for a in (0.0, 45.0) for f in [*decades(-15, -6), -1e-12, -1e-9, -1e-7, sqrt(2.0),
                                       1 / 3, 3e-8, 5e-8, 9e-8, 2e-7]]
    SWEEPS += sweep(f"nu, {_word}", patch, "nu",
                    [-0.99, -0.9, -0.5, 0.0, 1e-9, 0.3, 0.45, 0.49, 0.499, 0.4999, 0.499999],
                    **_domains)
    SWEEPS += sweep(f"modulus, {_word}", patch, "modulus", decades(-12, 15, 3), **_domains)
    SWEEPS += sweep(f"unit of length, {_word}", patch, "length", decades(-12, 12, 3), **_domains)
    SWEEPS += [Case(f"far away, {_word}", f"{d} h", patch(far=(d / 8, -d / 8), **_domains))
               for d in decades(1, 16)]
    SWEEPS += sweep(f"points per cell, {_word}", patch, "ppc", range(1, 9),
                    **{k: v for k, v in _domains.items() if k != "ppc"})
    SWEEPS += sweep(f"spacing, {_word}", patch, "h", [0.0625, 0.25, 0.5, 1.0, 2.0, 4.0, 16.0],
                    **_domains)
    SWEEPS += sweep(f"spacing, aligned, {_word}", patch, "h", [0.5, 1.0, 2.0, 4.0, 16.0, 1000.0],
                    angle=0.0, **_domains)
    SWEEPS += sweep(f"steps, {_word}", patch, "steps", [1, 2, 10, 100, 1000],
                    **_domains | (MPM_STEPS if _domains else {}))
    SWEEPS += sweep(f"stretch in one step, {_word}", patch, "stretch",
                    [1 - 1e-12, 1 - 1e-9, 1 - 1e-6, 1 - 1e-3, 0.99, 0.9, 0.8, 0.7, 0.5, 0.3],
                    **_domains)
    SWEEPS += sweep(f"column load, {_word}", column, "load",
                    [1e-9, 1e-6, 1e-3, 0.01, 0.1, 0.5, 1.0, 2.0, 4.0, 8.0], steps=20, **_domains
                    | (MPM_COLUMN if _domains else {}))
    SWEEPS += [Case(f"column steps, {_word}", f"{n}", column(load=1.0, steps=n, **_domains
               | (MPM_COLUMN if _domains else {}))) for n in (1, 2, 5, 20, 200)]
    SWEEPS += sweep(f"column density, {_word}", column, "density", decades(-12, 12, 4), **_domains
                    | (MPM_COLUMN if _domains else {}))
    SWEEPS += [Case(f"carried, {_word}", f"{s} h at {a} degrees", carried(
        step=s, angle=a, **_domains))
        for a in (0.0, 30.0) for s in (1e-9, 0.25, 0.5, 1.0, 1.5, 8.0)]
    # the last step starts at a stretch of two thirds, with points on faces of cells
    SWEEPS += [Case(f"points on faces, {_word}", f"{n} x {n} points", patch(
        angle=0.0, shift=(0.0, 0.0), stretch=0.6, steps=6, **_domains | {"ppc": n}
        | (MPM_STEPS if _domains else {}))) for n in (1, 2, 3, 4)]
    SWEEPS += [Case(f"unsupported, {_word}", kind, unsupported(kind, _domains.get("domains")))
               for kind in ("nothing", "weight alone", "weight, floor 0.5 h below",
                            "weight, floor 10 h below", "plate moves away",
                            "plate pushes, nothing behind", "held in x only, weight",
                            "held at one node, weight")]
    SWEEPS += [Case(f"free to slide, {_word}", "block on smooth floor",
                    sliding(domains=_domains.get("domains")))]

SWEEPS += sweep("long walls, mpm", patch, "angle", ANGLES, shift=(0.0, 0.0), overlong=True,
                bound=MPM_OVERLONG, **BOTH[1][1])
SWEEPS += sweep("wall of two segments", patch, "joint", [1e-9, 0.125, 0.3, 0.5, 1.0], angle=0.0,
                shift=(0.0, 0.0))
SWEEPS += sweep("two walls", corner, "opening", [5, 10, 20, 45, 60, 89, 90, 91, 120, 150, 170, 175, 179])
SWEEPS += sweep("two walls, h = 1", corner, "opening", [5, 20, 90, 150, 175], h=1.0)
SWEEPS += sweep("two walls, aligned", corner, "opening", [10, 45, 90, 135, 175], bisector=0.0,
                shift=(0.0, 0.0))
SWEEPS += sweep("column with walls", column, "shift", [0.0, 1e-9, 1e-3, 0.37, 0.5, 0.999],
                walls=True)
SWEEPS += sweep("column with walls, nu", column, "nu", [-0.5, 0.0, 0.3, 0.49, 0.4999],
                walls=True, shift=0.37)
SWEEPS += sweep("hourglass", patch, "hourglass", [0.0, 1e-3, 0.05, 0.5, 1.0])
SWEEPS += sweep("ghost penalty", patch, "ghost", [0.0, 1e-6, 1e-3, 1e-2, 0.1])
SWEEPS += [Case("neither", "hourglass 0, ghost_penalty 0", patch(hourglass=0.0, ghost=0.0))]
SWEEPS += sweep("keep small cells", patch, "angle", [0.0, 15.0, 30.0, 45.0], small_cells="keep")
SWEEPS += sweep("wedge, hourglass", wedge, "hourglass", [0.0, 0.05, 0.5, 1.0], bound=0.05)
SWEEPS += sweep("wedge, ghost penalty", wedge, "ghost", [0.0, 1e-4, 1e-3, 1e-2, 0.1], bound=0.05)
SWEEPS += sweep("wedge, steps", wedge, "steps", [1, 2, 3, 6, 12, 36, 200])
SWEEPS += sweep("wedge, band", wedge, "band", decades(-8, 0), bound=0.05)
SWEEPS += [Case("wedge, grid offset", f"{s} h", wedge(shift=(s, s), bound=0.02))
           for s in (1e-15, 1e-12, 1e-9, 1e-7, 1e-6, 1e-3, 0.25, 0.5, sqrt(0.5))]
SWEEPS += sweep("wedge, unit of length", wedge, "stretch_units", [1e-6, 1e-3, 1e3, 1e6])
