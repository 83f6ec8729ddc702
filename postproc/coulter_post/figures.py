"""Figures: frames of the deformed body, forces, convergence."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from .fields import FIELDS
from .results import Boundary, Frame, Grid, Results

#: Look of all figures.
STYLE = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.labelsize": 9.0,
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
INK, GRID_COLOUR = "#202428", "#e2e5e8"
#: Edges of point domains, on colours from dark to light.
EDGE_COLOUR = (1.0, 1.0, 1.0, 0.4)
#: Share of the points at either end of a field that may be left to the ends of the colour scale,
#: and by how much of the scale they must stick out for that.
OUTLIERS, STICKING_OUT = 0.002, 0.25
#: Height of the title of a panel and its ticks, and least width of a panel (inches).
TITLE, LEAST_WIDTH = 0.42, 1.5
#: Tools whose mean thickness is a smaller share of the picture have no room for their name.
SLENDER = 0.025
#: Most residual curves that get a label each.
MOST_LABELS = 10
#: Most points whose domains get an edge each.
MOST_EDGES = 6000


def draw_frames(results: Results, steps: Sequence[int] | None = None, field: str = "ux") -> Figure:
    """Frames side by side: point domains to scale, coloured by a field with common limits.

    Without `steps`, at most six frames are spread over the run.
    """
    frames = _chosen_frames(results, steps)
    quantity = FIELDS[field]
    values = [quantity.of(frame) for frame in frames]
    norm, extend = _colour_limits(values)
    view = _view(frames, results.grid)
    with mpl.rc_context(STYLE):
        figure, axes = _panels(len(frames), view)
        for number, (panel, frame, value) in enumerate(zip(axes, frames, values, strict=False)):
            _draw_grid(panel, results.grid, view)
            cells = PolyCollection(frame.outlines(), array=value, norm=norm, cmap="viridis")
            if len(value) <= MOST_EDGES:
                # snapped to pixels, some lines would be thicker than others
                cells.set(linewidths=0.25, edgecolors=EDGE_COLOUR, snap=False)
            else:
                # as wide as it takes to hide the seams
                cells.set(linewidths=0.5, edgecolors="face")
            panel.add_collection(cells)
            _draw_outline(panel, frame)
            for boundary in frame.boundaries:
                _draw_boundary(panel, boundary, view)
            letter = f"({chr(97 + number)})  " if len(frames) > 1 else ""
            panel.set_title(letter + _frame_title(frame))
            _set_view(panel, view)
        length = results.units.get("length", "")
        figure.supxlabel(_with_unit("x", length), fontsize=9)
        figure.supylabel(_with_unit("y", length), fontsize=9)
        bar = figure.colorbar(cells, ax=axes, shrink=0.8, aspect=35, pad=0.015, extend=extend)
        bar.set_label(_with_unit(quantity.label, results.unit(quantity.source)))
        bar.outline.set_visible(False)
        figure.suptitle(results.title, x=0.01, ha="left", fontsize=10.5)
    return figure


def draw_forces(results: Results) -> Figure | None:
    """Push force against displacement for every boundary that moves; None where none does."""
    history = results.history
    moves = history["boundary_displacements"]
    if len(moves) == 0:
        return None
    is_whole = history["is_complete"].astype(bool)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 3.6), layout="constrained")
        panel = figure.subplots()
        for index, name in enumerate(results.boundary_names):
            path = moves[:, index]
            length = np.linalg.norm(path, axis=1)
            if length.max() <= 0.0:
                continue
            direction = path[length.argmax()] / length.max()
            way = np.concatenate([[0.0], path @ direction])
            push = np.concatenate([[0.0], history["boundary_reactions"][:, index] @ direction])
            (line,) = panel.plot(way, push, label=name)
            panel.plot(way[1:][is_whole], push[1:][is_whole], "o", color=line.get_color())
        if not panel.lines:
            return None
        panel.axhline(0.0, color=INK, linewidth=0.6)
        units = results.units
        panel.set_xlabel(_with_unit("displacement of the boundary", units.get("length", "")))
        panel.set_ylabel(_with_unit("push force", units.get("force", "")))
        panel.set_title("push force on the body along the motion, compression positive")
        panel.grid(color=GRID_COLOUR)
        panel.set_axisbelow(True)
        panel.legend()
    return figure


def draw_tools(results: Results) -> Figure | None:
    """Force, moment, contact length and stations of every tool; None without tools."""
    history = results.history
    tools = [i for i, b in enumerate(results.frame(0).boundaries) if b.is_tool]
    if not tools or len(history["step"]) == 0:
        return None
    units = results.units
    length, force = units.get("length", ""), units.get("force", "")
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 5.6), layout="constrained")
        panels = figure.subplots(2, 2).ravel()
        for index in tools:
            name = results.boundary_names[index]
            way, label = _way_of(history, index, length)
            reaction = -history["boundary_reactions"][:, index]
            panels[0].plot(way, reaction[:, 0], label=f"{name}, x")
            panels[0].plot(way, reaction[:, 1], "--", label=f"{name}, y")
            panels[1].plot(way, -history["moments"][:, index], label=name)
            panels[2].plot(way, history["loaded_lengths"][:, index], label=name)
            panels[3].plot(way, history["n_sticking"][:, index], label=f"{name}, stick")
            panels[3].plot(way, history["n_slipping"][:, index], "--", label=f"{name}, slip")
        quantities = (
            (_with_unit("force", force), "force on the tool"),
            (_with_unit("moment", f"{force} {length}".strip()), "moment on the tool"),
            (_with_unit("length", length), "length in contact"),
            ("stations", "stations that stick and slip"),
        )
        for panel, (quantity, title) in zip(panels, quantities, strict=True):
            panel.set(xlabel=label, ylabel=quantity, title=title)
            panel.grid(color=GRID_COLOUR)
            panel.set_axisbelow(True)
            panel.legend(fontsize=7.5)
    return figure


def _way_of(history: dict[str, np.ndarray], index: int, length: str) -> tuple[np.ndarray, str]:
    """How far a boundary has come along its path, or turned if it stays, or the time."""
    steps = np.diff(history["boundary_displacements"][:, index], axis=0, prepend=0.0)
    way = np.cumsum(np.linalg.norm(steps, axis=1))
    turn = np.degrees(history["rotations"][:, index])
    if way[-1] > 0.0 and not np.any(turn):
        return way, _with_unit("way of the tool", length)
    if way[-1] == 0.0 and np.any(turn):
        return turn, "rotation of the tool (degrees)"
    return history["time"], "time"


def draw_tractions(results: Results, steps: Sequence[int] | None = None) -> Figure | None:
    """Normal pressure and shear along the outline of every tool; None where nothing touches."""
    frames = [frame for frame in _chosen_frames(results, steps) if frame.stations is not None]
    tools = [i for i, b in enumerate(results.frame(0).boundaries) if b.is_tool]
    frames = [f for f in frames if np.isin(f.stations.boundary, np.add(tools, 1)).any()]
    if not frames:
        return None
    length, stress = results.units.get("length", ""), results.units.get("stress", "")
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 2.9 * len(tools)), layout="constrained")
        panels = figure.subplots(len(tools), 2, squeeze=False)
        for row, index in zip(panels, tools, strict=True):
            for number, frame in enumerate(frames):
                colour = mpl.colormaps["viridis"](0.9 * number / max(1, len(frames) - 1))
                way, traction = _along_tool(frame, index)
                row[0].plot(way, -traction[:, 0], ".-", color=colour, label=_frame_title(frame))
                row[1].plot(way, traction[:, 1], ".-", color=colour)
            name = results.boundary_names[index]
            row[0].set(title=f"{name}: pressure", ylabel=_with_unit("pressure", stress))
            row[1].set(title=f"{name}: shear", ylabel=_with_unit("shear", stress))
            for panel in row:
                panel.set_xlabel(_with_unit("distance along the outline", length))
                panel.grid(color=GRID_COLOUR)
                panel.set_axisbelow(True)
            row[0].legend(fontsize=7.5)
    return figure


def _along_tool(frame: Frame, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Distance along the outline of a tool and traction of its stations, in that order."""
    line = frame.boundaries[index].polyline()
    mine = frame.stations.boundary == index + 1
    places, traction = frame.stations.position[mine], frame.stations.traction[mine]
    along = np.diff(line, axis=0)
    lengths = np.linalg.norm(along, axis=1)
    share = np.einsum("pki,ki->pk", places[:, None] - line[None, :-1], along) / lengths**2
    share = np.clip(share, 0.0, 1.0)
    feet = line[None, :-1] + share[..., None] * along
    nearest = np.linalg.norm(places[:, None] - feet, axis=2).argmin(axis=1)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    way = starts[nearest] + share[np.arange(len(nearest)), nearest] * lengths[nearest]
    # both ends of neighbouring edges stand at one place: their mean
    places, number = np.unique(np.round(way, 9), return_inverse=True)
    weight = frame.stations.length[mine]
    total = np.bincount(number, weight)
    mean = [np.bincount(number, weight * component) / total for component in traction.T]
    if len(places) > 1 and np.allclose(line[0], line[-1]):
        # what a closed outline cuts in two is shown in one piece
        seam = np.diff(places, append=places[0] + starts[-1]).argmax() + 1
        places = np.where(np.arange(len(places)) < seam, places + starts[-1], places)
        order = np.argsort(places)
        return places[order], np.column_stack(mean)[order]
    return places, np.column_stack(mean)


def _writer(path: Path) -> type[PillowWriter | FFMpegWriter]:
    """What writes a film: GIF needs nothing, all else ffmpeg, of the system or of imageio-ffmpeg."""
    if path.suffix.lower() == ".gif":
        return PillowWriter
    if not FFMpegWriter.isAvailable():
        try:
            from imageio_ffmpeg import get_ffmpeg_exe
        except ModuleNotFoundError:
            raise ValueError(
                f"{path}: needs ffmpeg, which is not installed (nor imageio-ffmpeg); a .gif does not"
            ) from None
        mpl.rcParams["animation.ffmpeg_path"] = get_ffmpeg_exe()
    return FFMpegWriter


def animate(results: Results, path: Path, field: str = "ux", frames_per_second: float = 8.0) -> None:
    """All frames as a moving picture: GIF, or MP4 and other films where ffmpeg is installed."""
    frames = [results.frame(index) for index in range(results.n_frames)]
    quantity = FIELDS[field]
    values = [quantity.of(frame) for frame in frames]
    norm, extend = _colour_limits(values)
    view = _view(frames, results.grid)
    writer = _writer(path)
    with mpl.rc_context(STYLE):
        figure, (panel,) = _panels(1, view)
        FigureCanvasAgg(figure)
        shade = ScalarMappable(norm=norm, cmap="viridis")
        bar = figure.colorbar(shade, ax=panel, shrink=0.8, aspect=35, pad=0.015, extend=extend)
        bar.set_label(_with_unit(quantity.label, results.unit(quantity.source)))
        bar.outline.set_visible(False)
        movie = writer(fps=frames_per_second)
        with movie.saving(figure, str(path), dpi=100):
            for frame, value in zip(frames, values, strict=True):
                panel.clear()
                _draw_grid(panel, results.grid, view)
                cells = PolyCollection(frame.outlines(), array=value, norm=norm, cmap="viridis")
                cells.set(linewidths=0.25, edgecolors="face")
                panel.add_collection(cells)
                _draw_outline(panel, frame)
                for boundary in frame.boundaries:
                    _draw_boundary(panel, boundary, view)
                panel.set_title(_frame_title(frame))
                _set_view(panel, view)
                movie.grab_frame()


def draw_convergence(results: Results) -> Figure | None:
    """Iterations per step, and the residuals of every step; None before the first step."""
    history = results.history
    if len(history["step"]) == 0:
        return None
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 3.6), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=[1, 1.4])
        _draw_iterations(left, history)
        _draw_residuals(right, history)
    return figure


def _draw_iterations(panel: Axes, history: dict[str, np.ndarray]) -> None:
    rows = np.arange(1, len(history["step"]) + 1)
    panel.bar(rows, history["n_iterations"], width=0.7, color="#5b8db8")
    labels = _row_labels(history)
    if len(rows) <= 20:
        panel.set_xticks(rows, labels)
    else:
        panel.xaxis.set_major_locator(MaxNLocator(integer=True))
    panel.yaxis.set_major_locator(MaxNLocator(integer=True))
    has_parts = not history["is_complete"].all()
    panel.set_xlabel("load step (+ part of a halved step)" if has_parts else "load step")
    panel.set_ylabel("Newton iterations")
    panel.set_title("iterations per step")


def _draw_residuals(panel: Axes, history: dict[str, np.ndarray]) -> None:
    n_rows = len(history["step"])
    colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.9, n_rows))
    labels = _row_labels(history)
    shown = set(np.unique(np.linspace(0, n_rows - 1, min(n_rows, MOST_LABELS)).astype(int)))
    for row in range(n_rows):
        residuals = history["residuals"][row]
        residuals = residuals[np.isfinite(residuals)]
        label = labels[row] if row in shown else None
        panel.semilogy(residuals, "o-", color=colours[row], markersize=3, label=label)
    panel.xaxis.set_major_locator(MaxNLocator(integer=True))
    panel.set_xlabel("Newton iteration")
    panel.set_ylabel("relative residual")
    panel.set_title("residual before every iteration and at the end")
    panel.grid(color=GRID_COLOUR)
    panel.set_axisbelow(True)
    panel.legend(title="step", loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)


def _row_labels(history: dict[str, np.ndarray]) -> list[str]:
    """Step numbers; a part of a step that was halved carries a plus sign."""
    pairs = zip(history["step"], history["is_complete"], strict=True)
    return [f"{step}" if is_complete else f"{step}+" for step, is_complete in pairs]


def _chosen_frames(results: Results, steps: Sequence[int] | None) -> list[Frame]:
    if steps:
        return [results.frame_of_step(step) for step in steps]
    n_frames = results.n_frames
    chosen = np.unique(np.linspace(0, n_frames - 1, min(n_frames, 6)).round().astype(int))
    return [results.frame(int(index)) for index in chosen]


def _colour_limits(values: list[np.ndarray]) -> tuple[Normalize, str]:
    """Common limits of the colours, and which ends of the scale stand for more than they say.

    A few points in a corner may carry a multiple of all others: they do not set the scale.
    """
    least, most = (float(pick([pick(v) for v in values])) for pick in (np.min, np.max))
    low = float(min(np.quantile(v, OUTLIERS) for v in values))
    high = float(max(np.quantile(v, 1.0 - OUTLIERS) for v in values))
    cuts_low = low - least > STICKING_OUT * (high - low)
    cuts_high = most - high > STICKING_OUT * (high - low)
    extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}
    norm = Normalize(low if cuts_low else least, high if cuts_high else most)
    return norm, extend[int(cuts_low), int(cuts_high)]


def _view(frames: list[Frame], grid: Grid) -> np.ndarray:
    """Lower and upper corner of what is shown: all frames and a margin, (2, 2)."""
    corners = np.concatenate([frame.outlines().reshape(-1, 2) for frame in frames])
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    margin = max(0.04 * (upper - lower).max(), 2.0 * grid.spacing.max())
    return np.array([lower - margin, upper + margin])


def _panels(n_panels: int, view: np.ndarray) -> tuple[Figure, list[Axes]]:
    """Axes of equal size, in as many columns as let them be largest on a page."""
    width, height = view[1] - view[0]
    scale, n_columns = max(
        (min(8.8 / columns / width, (8.6 / -(-n_panels // columns) - TITLE) / height), columns)
        for columns in range(1, n_panels + 1)
    )
    n_rows = -(-n_panels // n_columns)
    size = (
        n_columns * max(scale * width, LEAST_WIDTH) + 1.2,
        n_rows * (scale * height + TITLE) + 0.6,
    )
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(n_rows, n_columns, squeeze=False).ravel().tolist()
    for panel in axes[n_panels:]:
        panel.set_visible(False)
    return figure, axes


def _draw_grid(panel: Axes, grid: Grid, view: np.ndarray) -> None:
    (left, bottom), (right, top) = grid.origin, grid.origin + grid.spacing * grid.cells
    upright = [[(x, bottom), (x, top)] for x in grid.lines(0) if view[0, 0] <= x <= view[1, 0]]
    level = [[(left, y), (right, y)] for y in grid.lines(1) if view[0, 1] <= y <= view[1, 1]]
    lines = LineCollection(upright + level, colors=GRID_COLOUR, linewidths=0.4, zorder=0)
    panel.add_collection(lines)


def _draw_outline(panel: Axes, frame: Frame) -> None:
    """Where a tiled body ends."""
    edges = frame.outer_edges()
    panel.add_collection(LineCollection(edges, colors=INK, linewidths=0.6, capstyle="round"))


def _draw_boundary(panel: Axes, boundary: Boundary, view: np.ndarray) -> None:
    """The polyline, with its name outside the material, where most of a segment is to be seen.

    Slender tools have no room for it: it stands above them.
    """
    polyline = boundary.polyline()
    panel.plot(*polyline.T, color=INK, linewidth=2.0, solid_capstyle="round")
    top = polyline[np.argmax(polyline[:, 1])]
    room = 0.08 * (view[1] - view[0])[1]
    if _thickness(polyline) < SLENDER * (view[1] - view[0]).max() and top[1] + room < view[1, 1]:
        panel.annotate(
            boundary.name,
            top,
            xytext=(0.0, 4.0),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=7,
            color=INK,
        )
        return
    share = np.linspace(0.0, 1.0, 101)[:, None]
    seen, most, along = [], 0.0, np.zeros(2)
    for start, end in zip(boundary.vertices[:-1], boundary.vertices[1:], strict=True):
        places = (1.0 - share) * start + share * end
        places = places[np.all((places >= view[0]) & (places <= view[1]), axis=1)]
        length = float(np.linalg.norm(end - start))
        if len(places) * length > most:
            seen, most, along = places, len(places) * length, (end - start) / length
    if len(seen) == 0:
        return
    angle = (np.degrees(np.arctan2(along[1], along[0])) + 90.0) % 180.0 - 90.0
    outward = np.array([along[1], -along[0]])
    panel.annotate(
        boundary.name,
        seen[len(seen) // 2],
        xytext=7.5 * outward,
        textcoords="offset points",
        rotation=angle,
        ha="center",
        va="center",
        fontsize=7,
        color=INK,
        rotation_mode="anchor",
    )


def _thickness(polyline: np.ndarray) -> float:
    """Mean thickness of what a closed polyline bounds, infinite for an open one."""
    if not np.allclose(polyline[0], polyline[-1]):
        return np.inf
    x, y = polyline.T
    area = 0.5 * abs(float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])))
    return 2.0 * area / float(np.linalg.norm(np.diff(polyline, axis=0), axis=1).sum())


def _set_view(panel: Axes, view: np.ndarray) -> None:
    panel.set_aspect("equal")
    panel.set_xlim(view[:, 0])
    panel.set_ylim(view[:, 1])
    panel.spines[:].set_visible(False)
    panel.tick_params(length=2, labelsize=7.5)


def _frame_title(frame: Frame) -> str:
    if frame.step == 0:
        return "initial state"
    return f"step {frame.step},  {100.0 * frame.load_factor:.0f} %"


def _with_unit(label: str, unit: str) -> str:
    return f"{label} ({unit})" if unit not in ("", "1") else label
