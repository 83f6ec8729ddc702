"""Outlines of tools from drawings: DXF (with ezdxf) and SVG (with svgelements), curves flattened."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

#: Millimetres in a unit of length.
UNITS = {"um": 1e-3, "mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}
#: Largest distance between curve and chord, over the size of the drawing.
TOLERANCE = 1e-3
#: Ends nearer than this are one, over the size of the drawing.
GAP = 1e-6
#: Least number of parts of a curve of SVG: fewer may miss a bend.
LEAST_PARTS = 4
#: Bezier curves that ezdxf takes for a circle: 8 leave it by 4e-6 of its radius.
ARCS_PER_CIRCLE = 8
INKSCAPE_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


@dataclass
class Outline:
    """A chain of corners; a closed one does not repeat its first."""

    points: np.ndarray
    is_closed: bool
    layer: str

    def __str__(self) -> str:
        kind = "closed" if self.is_closed else "open"
        width, height = np.ptp(self.points, axis=0)
        return (f"{kind}, {len(self.points)} corners, {width:.6g} x {height:.6g},"
                f" layer '{self.layer}'")


def read(path: Path, layer: str | None = None, tolerance: float | None = None,
         unit: str | None = None) -> list[Outline]:
    """All outlines of a drawing, in its own unit of length or in the one that is asked for.

    `tolerance`, in that unit, is the largest distance between a curve and its chords. Raises
    ValueError with one line about what is wrong.
    """
    readers = {".dxf": _read_dxf, ".svg": _read_svg}
    if path.suffix.lower() not in readers:
        raise ValueError(f"{path}: is no drawing that can be read; known are DXF and SVG")
    if not path.is_file():
        raise ValueError(f"{path}: no such file")
    if tolerance is not None and not tolerance > 0.0:
        raise ValueError("the tolerance must be > 0")
    lines = readers[path.suffix.lower()](path, layer, tolerance, unit)
    if not lines:
        of_layer = f" in layer '{layer}'" if layer is not None else ""
        raise ValueError(f"{path}: holds no lines or curves{of_layer}")
    size = max(np.ptp(np.concatenate([line.points for line in lines]), axis=0))
    outlines = [_clean(outline, GAP * size) for outline in _join(lines, GAP * size)]
    return [outline for outline in outlines if len(outline.points) > 1 + outline.is_closed]


def choose(outlines: list[Outline], number: int | None, path: Path) -> Outline:
    """One of several outlines, by its number from 1; it may be left out if there is but one."""
    if number is None and len(outlines) == 1:
        return outlines[0]
    if number is not None and 1 <= number <= len(outlines):
        return outlines[number - 1]
    known = "; ".join(f"{i}: {outline}" for i, outline in enumerate(outlines, start=1))
    raise ValueError(f"{path}: holds {len(outlines)} outlines, choose one by --layer or --number"
                     f" ({known})")


def write(outline: Outline, path: Path, source: Path) -> None:
    """The table that a deck reads: `file` of a &tool."""
    kind = "polygon" if outline.is_closed else "polyline"
    rows = "".join(f"{x:.12g}, {y:.12g}\n" for x, y in outline.points)
    path.write_text(f"# {kind} of {source.name}, layer '{outline.layer}'\n# x, y\n{rows}")


def _read_dxf(path: Path, layer: str | None, tolerance: float | None,
              unit: str | None) -> list[Outline]:
    try:
        import ezdxf
        from ezdxf import units
        from ezdxf.path import bbox, make_path
    except ModuleNotFoundError:
        raise ValueError("DXF needs ezdxf: pip install ezdxf") from None
    try:
        drawing = ezdxf.readfile(path)
    except (ezdxf.DXFError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: is no DXF drawing: {error}") from None
    scale = 1.0
    if unit is not None:
        own = units.unit_name(drawing.units).lower() if drawing.units else ""
        own = {"millimeters": "mm", "centimeters": "cm", "meters": "m", "inches": "in",
               "feet": "ft", "microns": "um"}.get(own, "")
        if not own:
            raise ValueError(f"{path}: does not say its unit of length; give --scale, not --unit")
        scale = UNITS[own] / UNITS[unit]
    entities = list(_exploded(drawing.modelspace()))
    _check_layer(path, layer, {entity.dxf.layer for entity in entities})
    paths = []
    for entity in entities:
        if layer is None or entity.dxf.layer.lower() == layer.lower():
            try:
                paths.append((make_path(entity, segments=ARCS_PER_CIRCLE), entity.dxf.layer))
            except TypeError:  # texts, dimensions and the like are no curves
                continue
    box = bbox([curve for curve, _ in paths])
    if not box.has_data:
        return []
    limit = TOLERANCE * max(box.size) if tolerance is None else tolerance / scale
    return [
        Outline(scale * np.array([(p.x, p.y) for p in part.flattening(limit, 2)]),
                False, name)
        for curve, name in paths for part in curve.sub_paths() if len(part)
    ]


def _exploded(entities: Iterable[Any]) -> Iterable[Any]:
    """Entities, those of inserted blocks in place."""
    for entity in entities:
        if entity.dxftype() == "INSERT":
            yield from _exploded(entity.virtual_entities())
        else:
            yield entity


def _read_svg(path: Path, layer: str | None, tolerance: float | None,
              unit: str | None) -> list[Outline]:
    try:
        import svgelements
    except ModuleNotFoundError:
        raise ValueError("SVG needs svgelements: pip install svgelements") from None
    from xml.etree.ElementTree import ParseError

    try:
        drawing = svgelements.SVG.parse(str(path), reify=True)
    except (ParseError, ValueError) as error:
        raise ValueError(f"{path}: is no SVG drawing: {error}") from None
    pixels_per_mm = svgelements.Length("1mm").value(ppi=96.0)
    scale = 1.0 if unit is None else 1.0 / (pixels_per_mm * UNITS[unit])
    shapes = list(_shapes(drawing, "", svgelements))
    _check_layer(path, layer, {name for names, _ in shapes for name in names if name})
    curves = [(svgelements.Path(shape), names) for names, shape in shapes
              if layer is None or layer in names]
    boxes = np.array([box for curve, _ in curves if (box := curve.bbox()) is not None])
    if len(boxes) == 0:
        return []
    size = max(boxes[:, 2].max() - boxes[:, 0].min(), boxes[:, 3].max() - boxes[:, 1].min())
    limit = TOLERANCE * size if tolerance is None else tolerance / scale
    lines = []
    for curve, names in curves:
        for part in curve.as_subpaths():
            points = _flatten_svg(svgelements.Path(part), limit, svgelements)
            if len(points) > 1:
                # SVG counts y downwards
                group = names[-2] if len(names) > 1 else ""
                lines.append(Outline(scale * np.array(points) * [1, -1], False, group))
    return lines


def _shapes(group: Any, name: str, svgelements: Any, names: tuple = ()) -> Iterable[tuple]:
    """Shapes with the labels and ids of the groups that hold them, the innermost last."""
    for item in group:
        if isinstance(item, svgelements.Group):
            label = item.values.get(INKSCAPE_LABEL) or item.values.get("id") or ""
            yield from _shapes(item, label, svgelements, (*names, label))
        elif isinstance(item, svgelements.Shape):
            yield (*names, item.id or ""), item


def _flatten_svg(path: Any, limit: float, svgelements: Any) -> list[tuple[float, float]]:
    """Points along one sub-path."""
    points: list[tuple[float, float]] = []
    for segment in path:
        if isinstance(segment, svgelements.Move):
            points.append((segment.end.x, segment.end.y))
        elif isinstance(segment, (svgelements.Line, svgelements.Close)):
            if segment.end is not None:
                points.append((segment.end.x, segment.end.y))
        else:
            points.extend(_flatten(lambda t, s=segment: (s.point(t).x, s.point(t).y), limit))
    return points


def _flatten(curve: Callable[[float], tuple[float, float]],
             limit: float) -> list[tuple[float, float]]:
    """Points of a curve over 0..1 but the first, whose chords leave it by no more than a limit."""
    points: list[tuple[float, float]] = []

    def add(start: float, end: float, depth: int) -> None:
        first, last, middle = (np.array(curve(t)) for t in (start, end, 0.5 * (start + end)))
        chord = last - first
        length = float(np.hypot(*chord))
        offset = middle - first
        away = abs(chord[0] * offset[1] - chord[1] * offset[0]) / length if length > 0 else math.inf
        if depth == 0 or (away <= limit and length > 0):
            points.append((float(last[0]), float(last[1])))
        else:
            add(start, 0.5 * (start + end), depth - 1)
            add(0.5 * (start + end), end, depth - 1)

    for k in range(LEAST_PARTS):
        add(k / LEAST_PARTS, (k + 1) / LEAST_PARTS, 12)
    return points


def _check_layer(path: Path, layer: str | None, known: set[str]) -> None:
    if layer is None or layer.lower() in {name.lower() for name in known}:
        return
    names = ", ".join(sorted(known)) or "none"
    raise ValueError(f"{path}: has no layer '{layer}'; known are {names}")


def _join(lines: list[Outline], gap: float) -> list[Outline]:
    """Chains of lines whose ends meet; a chain whose ends meet is closed."""
    rest = list(lines)
    chains = []
    while rest:
        chain = rest.pop(0)
        points = chain.points
        while not _meet(points[0], points[-1], gap, len(points)):
            for k, other in enumerate(rest):
                if other.layer != chain.layer:
                    continue
                joined = _append(points, other.points, gap)
                if joined is not None:
                    points = joined
                    del rest[k]
                    break
            else:
                break
        is_closed = _meet(points[0], points[-1], gap, len(points))
        chains.append(Outline(points[:-1] if is_closed else points, is_closed, chain.layer))
    return chains


def _meet(first: np.ndarray, last: np.ndarray, gap: float, n_points: int) -> bool:
    return n_points > 3 and bool(np.hypot(*(last - first)) <= gap)


def _append(points: np.ndarray, other: np.ndarray, gap: float) -> np.ndarray | None:
    """Both lines as one, turned as need be; None where no ends meet."""
    for head in (points, points[::-1]):
        for tail in (other, other[::-1]):
            if np.hypot(*(tail[0] - head[-1])) <= gap:
                return np.concatenate([head, tail[1:]])
    return None


def _clean(outline: Outline, gap: float) -> Outline:
    """Without corners that coincide or lie on a straight line; closed ones counter-clockwise."""
    points = outline.points
    for _ in range(2):
        before = np.roll(points, 1, axis=0)
        after = np.roll(points, -1, axis=0)
        to, onward = points - before, after - points
        keep = np.hypot(*to.T) > gap
        turn = np.abs(to[:, 0] * onward[:, 1] - to[:, 1] * onward[:, 0])
        keep &= turn > gap * np.hypot(*onward.T)
        if not outline.is_closed:
            keep[[0, -1]] = True
        points = points[keep]
    x, y = points.T
    if outline.is_closed and np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) < 0.0:
        points = points[::-1]
    return Outline(points, outline.is_closed, outline.layer)
