"""The problems: how a deck of them is written, and how far a result is from the truth."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from coulter_post import Results
from coulter_post.results import Frame


@dataclass(frozen=True)
class Scheme:
    """A way of solving: what it adds to a deck."""

    points: int = 1  #: per cell and direction
    control: str = ""  #: variables of &control
    boundary: str = ""  #: variables of every &boundary
    bilateral: bool = True  #: do boundaries understand `bilateral`?


MPM = "domains = 'mpm'"
GIMP = "domains = 'gimp'"
PENALTY = "formulation = 'penalty', band_ratio = 0.05, "
SCHEMES = {
    "default": Scheme(),
    "default_2x2": Scheme(points=2),
    "default_fbar": Scheme(points=2, control="volumetric = 'fbar'"),
    "paper": Scheme(2, MPM, "formulation = 'implicit', ", bilateral=False),
    "penalty": Scheme(2, MPM, PENALTY, bilateral=False),
    "memory": Scheme(2, MPM, PENALTY + "memory = .true., ", bilateral=False),
    "mpm_fbar": Scheme(
        2, MPM + ", volumetric = 'fbar'", PENALTY + "memory = .true., ", bilateral=False
    ),
    "gimp": Scheme(2, GIMP, PENALTY + "memory = .true., ", bilateral=False),
    "gimp_fbar": Scheme(
        2, GIMP + ", volumetric = 'fbar'", PENALTY + "memory = .true., ", bilateral=False
    ),
}
#: Schemes of a problem that names none.
USUAL = ("default", "default_2x2", "paper", "penalty", "memory", "gimp", "gimp_fbar")


@dataclass(frozen=True)
class Problem:
    """A problem with a known answer."""

    title: str
    measure: str  #: what the error is
    deck: Callable[[int, int, Scheme], str]  #: cells, steps, scheme
    error: Callable[[Results], float]
    cells: tuple[int, ...]  #: cells along the characteristic length
    steps: int
    schemes: tuple[str, ...] = USUAL
    #: other numbers of steps, for some of the schemes
    other_steps: tuple[int, ...] = ()
    longest: int = 200  #: seconds that one run may take


# --- text of decks --------------------------------------------------------------------------------


def listed(*values: float) -> str:
    """Numbers as a deck takes them, to the last digit."""
    return ", ".join(repr(float(value)) for value in values)


def boundary(name: str, kind: str, vertices: list, scheme: Scheme, more: str = "") -> str:
    """A polyline; the material is on its left."""
    corners = listed(*(x for corner in vertices for x in corner))
    text = f"{scheme.boundary}vertices = {corners}{more}"
    return f"&boundary name = '{name}', kind = '{kind}', {text} /\n"


def held(scheme: Scheme) -> str:
    """Hold material against pulling off, where the scheme lets it pull off otherwise."""
    return ", bilateral = .true." if scheme.bilateral else ""


def grid(origin: tuple, spacing: float, cells: tuple) -> str:
    """A grid of square cells."""
    return (
        f"&grid origin = {listed(*origin)}, spacing = {listed(spacing)},"
        f" cells = {cells[0]}, {cells[1]} /\n"
    )


def material(
    modulus: float, ratio: float, density: float, corners: list, scheme: Scheme, more: str = ""
) -> str:
    """A polygon of one law."""
    flat = listed(*(x for corner in corners for x in corner))
    return (
        f"&law name = 'law', youngs_modulus = {listed(modulus)},"
        f" poisson_ratio = {listed(ratio)}{more} /\n"
        f"&body name = 'body', law = 'law', density = {listed(density)},"
        f" points_per_cell = {scheme.points} /\n"
        f"&region body = 'body', polygon = {flat} /\n"
    )


def ending(steps: int, scheme: Scheme) -> str:
    """Steps, control, and the last step as only output."""
    control = f"&control {scheme.control} /\n" if scheme.control else ""
    return f"&steps count = {steps} /\n&output at_steps = {steps} /\n{control}"


def turned(degrees: float) -> Callable[[float, float], tuple[float, float]]:
    """Rotation of a place about the origin."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return lambda x, y: (c * x - s * y, s * x + c * y)


def square_grid(corners: list, margin: float, h: float) -> str:
    """A grid around some places that fits nothing."""
    low = np.min(corners, axis=0) - margin - h * np.array([0.41, 0.37])
    cells = np.ceil((np.max(corners, axis=0) + margin - low) / h).astype(int)
    return grid(tuple(low), h, tuple(cells))


# --- what a frame tells ---------------------------------------------------------------------------


def last_frame(results: Results) -> Frame:
    """The state after the last step; a run that broke off has no error."""
    if results.provenance["status"] != "finished":
        raise ValueError(results.provenance["status"])
    return results.frame(-1)


def reference_volume(frame: Frame) -> np.ndarray:
    """Volume of the points before the deformation."""
    return frame["volume"] / frame["volume_ratio"]


# --- column under its own weight ------------------------------------------------------------------

COLUMN_HEIGHT, COLUMN_WEIGHT, COLUMN_MODULUS = 50.0, 800.0, 1.0e4


def column_on_grid(n: int, steps: int, scheme: Scheme) -> str:
    """The column of the AMPLE code: one cell wide, its nodes held."""
    h = COLUMN_HEIGHT / n
    return (
        grid((0.0, 0.0), h, (1, n + 1))
        + column_material(h, scheme)
        + "&fixity name = 'left', side = 'left', held = 'x' /\n"
        + "&fixity name = 'right', side = 'right', held = 'x' /\n"
        + "&fixity name = 'base', side = 'bottom', held = 'y' /\n"
        + ending(steps, scheme)
    )


def column_off_grid(n: int, steps: int, scheme: Scheme) -> str:
    """The same column between rollers that cut the cells."""
    h = COLUMN_HEIGHT / n
    top, more = COLUMN_HEIGHT + h, held(scheme)
    return (
        grid((-0.41 * h, -0.37 * h), h, (2, n + 2))
        + column_material(h, scheme)
        + boundary("base", "roller", [(-0.3 * h, 0.0), (1.3 * h, 0.0)], scheme, more)
        + boundary("right", "roller", [(h, -0.3 * h), (h, top)], scheme, more)
        + boundary("left", "roller", [(0.0, top), (0.0, -0.3 * h)], scheme, more)
        + ending(steps, scheme)
    )


def column_material(h: float, scheme: Scheme) -> str:
    """One cell of material in width, under gravity."""
    corners = [(0.0, 0.0), (h, 0.0), (h, COLUMN_HEIGHT), (0.0, COLUMN_HEIGHT)]
    return (
        material(COLUMN_MODULUS, 0.0, 80.0, corners, scheme)
        + "&body_force acceleration = 0.0, -10.0 /\n"
    )


def column_error(results: Results) -> float:
    """Sum of the errors of the vertical stress over the stress at the base."""
    frame = last_frame(results)
    height = results.frame(0).position[:, 1]
    exact = -COLUMN_WEIGHT * (COLUMN_HEIGHT - height)
    wrong = np.abs(frame["stress"][:, 1] - exact)
    return float(np.average(wrong, weights=reference_volume(frame))) / (
        COLUMN_WEIGHT * COLUMN_HEIGHT
    )


# --- rotated patch --------------------------------------------------------------------------------

PATCH_ANGLE, PATCH_STRETCH, PATCH_MODULUS, PATCH_RATIO = 30.0, 0.9, 1000.0, 0.3


def patch(n: int, steps: int, scheme: Scheme) -> str:
    """A unit square, turned against the grid, compressed between rollers; one side is free."""
    place, down = turned(PATCH_ANGLE), PATCH_STRETCH - 1.0
    corners = [place(0, 0), place(1, 0), place(1, 1), place(0, 1)]
    push = f", displacement = {listed(*place(0.0, down))}"
    return (
        square_grid(corners + [place(1.2, 1.0)], 0.1, 1.0 / n)
        + material(PATCH_MODULUS, PATCH_RATIO, 0.0, corners, scheme)
        + boundary("base", "roller", [place(0, 0), place(1.2, 0)], scheme)
        + boundary("left", "roller", [place(0, 1), place(0, 0)], scheme)
        + boundary("top", "roller", [place(1.2, 1), place(0, 1)], scheme, push)
        + ending(steps, scheme)
    )


def patch_error(results: Results) -> float:
    """Root mean square of the error of the stress over the exact stress."""
    frame = last_frame(results)
    along = math.log(PATCH_STRETCH)
    across = -PATCH_RATIO / (1.0 - PATCH_RATIO) * along
    exact = PATCH_MODULUS / (1.0 - PATCH_RATIO**2) * along / math.exp(along + across)
    x, y = turned(PATCH_ANGLE)(0.0, 1.0)
    xx, yy, _, xy, _, _ = frame["stress"].T
    wrong = (xx - exact * x * x) ** 2 + (yy - exact * y * y) ** 2 + 2 * (xy - exact * x * y) ** 2
    mean = np.average(wrong, weights=reference_volume(frame))
    return float(math.sqrt(mean)) / abs(exact)


# --- cantilever held by an inclined wall ----------------------------------------------------------

#: Mean deflection of the cantilever: finest grids, see docs/accuracy.md.
BEAM_ANGLE, BEAM_LOAD, BEAM_DEFLECTION = 30.0, 1000.0, 0.48230


def beam(n: int, steps: int, scheme: Scheme) -> str:
    """A beam, 10 long and 1 high, turned against the grid, bent by its weight across it."""
    place = turned(BEAM_ANGLE)
    corners = [place(0, 0), place(10, 0), place(10, 1), place(0, 1)]
    wall = [place(0, 1.3), place(0, -0.3)]
    return (
        square_grid(corners + [place(10, -1.5)], 0.3, 1.0 / n)
        + material(12.0e6, 0.2, 1.0, corners, scheme)
        + boundary("wall", "fixed", wall, scheme, held(scheme))
        + f"&body_force acceleration = {listed(*place(0.0, -BEAM_LOAD))} /\n"
        + ending(steps, scheme)
    )


def beam_deflection(results: Results) -> float:
    """Mean displacement across the beam."""
    frame = last_frame(results)
    across = frame["displacement"][:, :2] @ np.array(turned(BEAM_ANGLE)(0.0, -1.0))
    return float(np.average(across, weights=reference_volume(frame)))


def beam_error(results: Results) -> float:
    """Error of the mean deflection."""
    return abs(beam_deflection(results) / BEAM_DEFLECTION - 1.0)


# --- bending of a block that is cut out of the grid at an angle -----------------------------------

CUT_ANGLE, CUT_PRESS, CUT_TURN = 30.0, 2.0e-5, 1.0e-5


def cut(n: int, steps: int, scheme: Scheme) -> str:
    """A unit square on a smooth base that cuts the cells, bent by a smooth platen that turns.

    Walls that turn are tools, which only push: the platen also presses, twice as far as it lifts. A
    node held along x keeps the block from sliding and carries nothing.
    """
    h, place = 1.0 / n, turned(CUT_ANGLE)
    corners = [place(0, 0), place(1, 0), place(1, 1), place(0, 1)]
    low = np.min(corners, axis=0) - 0.3 - h * np.array([0.41, 0.37])
    pin = low + h * np.round((np.array(place(0.5, 0.5)) - low) / h)
    platen = listed(*place(1.3, 1), *place(-0.3, 1))
    return (
        square_grid(corners, 0.3, h)
        + material(PATCH_MODULUS, PATCH_RATIO, 0.0, corners, scheme)
        + boundary("base", "roller", [place(-0.3, 0), place(1.3, 0)], scheme)
        + f"&tool name = 'platen', shape = 'polyline', vertices = {platen},"
        + f" displacement = {listed(*place(0.0, -CUT_PRESS))}, pivot = {listed(*place(0.5, 1))},"
        + f" rotation = {listed(-math.degrees(CUT_TURN))} /\n"
        + f"&fixity name = 'pin', lower = {listed(*(pin - 0.1 * h))},"
        + f" upper = {listed(*(pin + 0.1 * h))}, held = 'x' /\n"
        + ending(steps, scheme)
    )


def cut_error(results: Results) -> float:
    """Root mean square of the error of the stress over that of the bending stress."""
    frame = last_frame(results)
    across, along = (np.array(turned(CUT_ANGLE)(*axis)) for axis in [(1.0, 0.0), (0.0, 1.0)])
    modulus = PATCH_MODULUS / (1.0 - PATCH_RATIO**2)
    bending = modulus * CUT_TURN * (0.5 - results.frame(0).position[:, :2] @ across)
    xx, yy, _, xy, _, _ = frame["stress"].T
    stress = np.array([[xx, xy], [xy, yy]])
    exact = np.multiply.outer(np.outer(along, along), bending - modulus * CUT_PRESS)
    wrong = np.sum((stress - exact) ** 2, axis=(0, 1))
    volume = reference_volume(frame)
    return float(
        math.sqrt(np.average(wrong, weights=volume) / np.average(bending**2, weights=volume))
    )


# --- cantilever that bends far down ---------------------------------------------------------------

#: Displacement of the tip over the length: finite elements (Q9, 40 x 4).
TIP = np.array([-0.55521, -0.82783])


def cantilever(n: int, steps: int, scheme: Scheme) -> str:
    """A beam, 10 long and 1 high, clamped on the left, under a dead load at its tip."""
    corners = [(0, 0), (10, 0), (10, 1), (0, 1)]
    return (
        grid((-1.0, -10.0), 1.0 / n, (13 * n, 12 * n))
        + material(12.0e6, 0.2, 0.0, corners, scheme)
        + boundary("clamp", "fixed", [(0, 1), (0, 0)], scheme)
        + "&edge_load name = 'tip', vertices = 10.0, 0.0, 10.0, 1.0, traction = 0.0, -1.0e5 /\n"
        + ending(steps, scheme)
    )


def cantilever_error(results: Results) -> float:
    """Distance of the tip from where finite elements put it, over the length."""
    start, end = results.frame(0).outlines(), last_frame(results).outlines()
    at_tip = start[:, :, 0] > 10.0 - 1.0e-6
    return float(np.linalg.norm(np.mean((end - start)[at_tip], axis=0) / 10.0 - TIP))


# --- wedge ----------------------------------------------------------------------------------------

#: Push force at 36 mm: finite elements that follow the material.
WEDGE_ANGLE, WEDGE_FORCE = 20.0, 4518.0


def wedge(n: int, steps: int, scheme: Scheme) -> str:
    """Soil, 60 mm high, is pushed up a wedge by 36 mm; the floor ends at the toe of the wedge.

    Plain points cannot be held in the concave corner: for them the floor starts 20 mm behind the
    toe. The tiles give the same force, to 0.02 %, with either floor.
    """
    h, slope = 60.0 / n, math.tan(math.radians(WEDGE_ANGLE))
    toe = 0.0 if scheme.bilateral else 20.0
    corners = [(-20.0, 20.0 * slope), (0, 0), (120, 0), (120, 60), (-20, 60)]
    push = ", displacement = -36.0, 0.0"
    below = 2 if n % 2 == 0 else 1
    cells = (math.ceil(272.0 / h), n + 2 * below)
    return (
        grid((-75.0 * 2.0, -below * h), h, cells)
        + material(1000.0, 0.3, 0.0, corners, scheme)
        + boundary("floor", "roller", [(toe, 0.0), (120.0, 0.0)], scheme)
        + boundary("wedge", "roller", [(-148.0, 148.0 * slope), (0.0, 0.0)], scheme)
        + boundary("top", "roller", [(120.0, 60.0), (-148.0, 60.0)], scheme)
        + boundary("push", "roller", [(120.0, 0.0), (120.0, 60.0)], scheme, push)
        + ending(steps, scheme)
    )


def wedge_error(results: Results) -> float:
    """Error of the push force."""
    last_frame(results)
    reactions = results.history["boundary_reactions"][-1]
    force = -reactions[results.boundary_names.index("push"), 0]
    return abs(float(force) / WEDGE_FORCE - 1.0)


# --- strip footing --------------------------------------------------------------------------------

#: Prandtl's factor of bearing capacity.
BEARING = 2.0 + math.pi


def footing(n: int, steps: int, scheme: Scheme) -> str:
    """Half of a smooth strip footing of half-width 1 on weightless clay of strength 1, to failure.

    On tiles it is a tool, whose faces end openly; plain points only know boundaries.
    """
    h, more, way = 1.0 / n, held(scheme), (0.0, -4.0e-4)
    corners = [(0, 0), (5, 0), (5, 2.5), (0, 2.5)]
    strength = ", model = 'tresca', shear_strength = 1.0"
    push = f", displacement = {listed(*way)}"
    tool = f"&tool name = 'footing', shape = 'rectangle', size = 2.0, 1.0, position = 0.0, 2.5{push} /\n"
    plate = boundary("footing", "roller", [(1, 2.5), (0, 2.5)], scheme, push)
    return (
        grid((-h, -h), h, (5 * n + 3, math.ceil(2.5 * n) + 3))
        + material(1.0e5, 0.49, 0.0, corners, scheme, strength)
        + boundary("base", "fixed", [(0, 0), (5, 0)], scheme, more)
        + boundary("left", "roller", [(0, 2.5), (0, 0)], scheme, more)
        + boundary("right", "roller", [(5, 0), (5, 2.5)], scheme, more)
        + (tool if scheme.bilateral else plate)
        + ending(steps, scheme)
    )


def footing_error(results: Results) -> float:
    """Relative error of the bearing capacity."""
    last_frame(results)
    where = results.boundary_names.index("footing")
    return abs(-results.history["boundary_reactions"][-1, where, 1] / BEARING - 1.0)


# --- all of them ----------------------------------------------------------------------------------

STRESS = "relative error of the stress"
#: For problems with loads on edges or walls that turn, which plain points do not know.
TILES = ("default", "default_2x2")
PROBLEMS = {
    "column": Problem(
        "Column, walls on grid lines",
        STRESS,
        column_on_grid,
        column_error,
        (4, 8, 16, 32, 64, 128),
        40,
        ("default", "default_2x2", "paper", "gimp"),
        (10,),
    ),
    "column_off": Problem(
        "Column, walls off the grid",
        STRESS,
        column_off_grid,
        column_error,
        (4, 8, 16, 32, 64, 128),
        40,
        other_steps=(10,),
    ),
    "patch": Problem(
        "Patch turned by 30 degrees",
        STRESS,
        patch,
        patch_error,
        (4, 8, 16, 32),
        1,
        other_steps=(20,),
    ),
    "beam": Problem(
        "Cantilever turned by 30 degrees",
        "relative error of the deflection",
        beam,
        beam_error,
        (2, 4, 8, 10, 16),
        5,
    ),
    "cut": Problem(
        "Bending of a block cut at 30 degrees",
        STRESS,
        cut,
        cut_error,
        (4, 8, 16, 32, 64),
        1,
        TILES,
    ),
    "cantilever": Problem(
        "Cantilever, tip 0.83 lengths down",
        "distance of the tip over the length",
        cantilever,
        cantilever_error,
        (2, 4, 8, 16),
        20,
        TILES,
        (10,),
    ),
    "footing": Problem(
        "Strip footing on clay",
        "relative error of the bearing capacity",
        footing,
        footing_error,
        (2, 4, 8, 16, 24),
        8,
        ("default", "default_2x2", "default_fbar", "mpm_fbar", "gimp_fbar"),
    ),
    "wedge": Problem(
        "Wedge of 20 degrees",
        "relative error of the push force",
        wedge,
        wedge_error,
        (10, 15, 20, 30),
        6,
        other_steps=(30,),
    ),
}
