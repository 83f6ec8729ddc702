"""Reader of results files; docs/results.md describes their layout."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TypeVar

import h5py
import numpy as np

T = TypeVar("T")
#: Data of the history that have no row per step.
LISTS = (
    "phase_names",
    "fixity_names",
    "warning_rows",
    "warning_texts",
    "reset_rows",
    "reset_residuals",
    "reset_force_changes",
)
#: Attempts to read a file into which a run may be writing, and the pause between them (s).
ATTEMPTS, PAUSE = 10, 0.1


@dataclass(frozen=True)
class Grid:
    """Background grid: lower corner, edge lengths of a cell, cells per direction."""

    origin: np.ndarray
    spacing: np.ndarray
    cells: np.ndarray

    def lines(self, direction: int) -> np.ndarray:
        """Coordinates of the grid lines across a direction."""
        return self.origin[direction] + self.spacing[direction] * np.arange(
            self.cells[direction] + 1
        )


@dataclass(frozen=True)
class Boundary:
    """A boundary in one frame; the material is on the left of the polyline."""

    name: str
    kind: str
    vertices: np.ndarray
    is_tool: bool = False
    bulges: np.ndarray | None = None

    def polyline(self) -> np.ndarray:
        """Corners with the arcs between them, (n, 2)."""
        if self.bulges is None or not np.any(self.bulges):
            return self.vertices
        points = [self.vertices[:1]]
        ends = zip(self.vertices[:-1], self.vertices[1:], self.bulges, strict=False)
        for first, last, bulge in ends:
            points.append(_arc(first, last, bulge) if bulge else last[None])
        return np.concatenate(points)


@dataclass(frozen=True)
class Stations:
    """Where walls and tools press in one frame; traction (n, 2): normal, tension positive, shear."""

    boundary: np.ndarray
    slip: np.ndarray
    position: np.ndarray
    length: np.ndarray
    traction: np.ndarray


@dataclass(frozen=True)
class Frame:
    """The points at one moment: positions (n, 3), point data by name, (n,) or (n, components)."""

    step: int
    time: float
    load_factor: float
    position: np.ndarray
    data: dict[str, np.ndarray]
    boundaries: list[Boundary]
    stations: Stations | None = None

    def __getitem__(self, name: str) -> np.ndarray:
        return self.data[name]

    @property
    def has_tiles(self) -> bool:
        """Do the point domains tile the body, with corners in common?"""
        return "tile" in self.data

    @property
    def gradient(self) -> np.ndarray:
        """Deformation gradient as matrices, (n, 3, 3)."""
        return self.data["deformation_gradient"].reshape(-1, 3, 3)

    def outlines(self) -> np.ndarray:
        """Corners of the deformed point domains in the plane, (n, 4, 2).

        Domains that tile the body are known by their corners; a triangle repeats its third one.
        Others are boxes; one that was cut where the body ends is drawn shrunk to its volume.
        """
        if self.has_tiles:
            return self.data["tile"].reshape(-1, 4, 2)
        box = self.data["domain"][:, :2]
        share = self.data["volume"] / self.data["volume_ratio"] / np.prod(box, axis=1)
        box = box * np.sqrt(np.minimum(share, 1.0))[:, None]
        corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
        offsets = np.einsum("pij,pkj->pki", self.gradient[:, :2, :2], box[:, None, :] * corners)
        return self.position[:, None, :2] + offsets

    def outer_edges(self) -> np.ndarray:
        """Edges of tiles that no other tile has, both ends, (n, 2, 2); none without tiles."""
        if not self.has_tiles:
            return np.empty((0, 2, 2))
        corners = self.outlines()
        # common corners have the same digits in all tiles
        places, numbers = np.unique(corners.reshape(-1, 2), axis=0, return_inverse=True)
        starts = numbers.reshape(-1, 4)
        edges = np.stack([starts, np.roll(starts, -1, axis=1)], axis=-1).reshape(-1, 2)
        edges = edges[edges[:, 0] != edges[:, 1]]
        _, first, count = np.unique(
            np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True
        )
        return places[edges[first[count == 1]]]


class Results:
    """A results file, also of a run that goes on; every access sees what is complete by then."""

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        if not self.path.is_file():
            raise FileNotFoundError(f"there is no results file {self.path}")
        if not self._read(lambda file: "VTKHDF" in file and "history" in file):
            raise ValueError(f"{self.path} is not a results file of Coulter")

    @contextmanager
    def _open(self) -> Iterator[h5py.File]:
        with h5py.File(self.path, "r", locking=False) as file:
            yield file

    def _read(self, query: Callable[[h5py.File], T]) -> T:
        """Ask the file; again after a moment where the run was just writing."""
        for attempt in range(ATTEMPTS):
            try:
                with self._open() as file:
                    return query(file)
            except OSError:
                if attempt == ATTEMPTS - 1:
                    raise
                time.sleep(PAUSE)
        raise AssertionError

    @cached_property
    def title(self) -> str:
        """Title of the scene."""
        return self._read(lambda file: _text(file.attrs["title"]))

    @cached_property
    def units(self) -> dict[str, str]:
        """Labels of length, stress and force; empty where unknown."""
        return self._read(lambda file: _attributes(file["units"]))

    @property
    def provenance(self) -> dict[str, str]:
        """Program, build, start and status of the run."""
        return self._read(lambda file: _attributes(file["provenance"]))

    @cached_property
    def deck(self) -> str:
        """The deck from which the run was made."""
        return self._read(lambda file: _text(file["deck"][0]))

    @cached_property
    def grid(self) -> Grid:
        """Background grid."""
        return self._read(
            lambda file: Grid(*(file[f"grid/{name}"][:] for name in ("origin", "spacing", "cells")))
        )

    @cached_property
    def boundary_names(self) -> list[str]:
        """Names of the boundaries, in the order of their reactions."""
        return self._read(lambda file: [_text(name) for name in file["boundaries/name"]])

    @property
    def n_frames(self) -> int:
        """Number of frames so far."""
        return self._read(_frame_count)

    @property
    def steps(self) -> np.ndarray:
        """Number of the load step of every frame, 0 for the initial state."""
        return self._read(lambda file: file["frames/step"][: _frame_count(file)])

    @property
    def times(self) -> np.ndarray:
        """Time of every frame."""
        return self._read(lambda file: file["VTKHDF/Steps/Values"][: _frame_count(file)])

    @property
    def history(self) -> dict[str, np.ndarray]:
        """Columns of the history by name; a row per accepted step or part of a step."""

        def query(file: h5py.File) -> dict[str, np.ndarray]:
            group = file["history"]
            n_rows = int(group.attrs["n_rows"])
            return {
                name: column[:n_rows]
                for name, column in group.items()
                if name not in LISTS
            }

        return self._read(query)

    @property
    def warnings(self) -> list[tuple[int, str]]:
        """Warnings of the steps, each with its row in the history."""

        def query(file: h5py.File) -> list[tuple[int, str]]:
            group = file["history"]
            if "warning_rows" not in group:
                return []
            n_rows = int(group.attrs["n_rows"])
            pairs = zip(group["warning_rows"], group["warning_texts"], strict=False)
            return [(int(row), _text(text)) for row, text in pairs if row < n_rows]

        return self._read(query)

    @property
    def resets(self) -> list[tuple[int, float, np.ndarray]]:
        """Where bodies were tiled anew: row in the history, residual, changes of forces in the next step."""

        def query(file: h5py.File) -> list[tuple[int, float, np.ndarray]]:
            group = file["history"]
            if "reset_rows" not in group:
                return []
            n_rows = int(group.attrs["n_rows"])
            lists = (group["reset_rows"], group["reset_residuals"], group["reset_force_changes"])
            return [
                (int(row), float(residual), np.asarray(changes))
                for row, residual, changes in zip(*lists, strict=False)
                if row < n_rows
            ]

        return self._read(query)

    @cached_property
    def phase_names(self) -> list[str]:
        """Names of the timed phases, in the order of `phase_seconds`."""
        return self._read(lambda file: [_text(name) for name in file["history/phase_names"]])

    @cached_property
    def fixity_names(self) -> list[str]:
        """Names of the fixities, in the order of their reactions."""
        return self._read(lambda file: [_text(name) for name in file["history/fixity_names"]])

    def unit(self, dataset: str) -> str:
        """Unit of a dataset, given by its path or, for point data, by its name."""
        path = dataset if "/" in dataset else f"VTKHDF/PointData/{dataset}"
        return self._read(lambda file: _text(file[path].attrs.get("unit", b"")))

    def frame(self, index: int) -> Frame:
        """A frame by its index, from 0; negative indices count from the end."""
        return self._read(lambda file: _frame(file, range(_frame_count(file))[index]))

    def frame_of_step(self, step: int) -> Frame:
        """The frame at the end of a load step; 0 is the initial state."""
        steps = self.steps
        (found,) = np.nonzero(steps == step)
        if len(found) == 0:
            known = ", ".join(str(number) for number in steps)
            raise KeyError(f"no frame of step {step} in {self.path}; there are {known}")
        return self.frame(int(found[0]))


def _frame_count(file: h5py.File) -> int:
    return int(file["VTKHDF/Steps"].attrs["NSteps"])


def _frame(file: h5py.File, index: int) -> Frame:
    root = file["VTKHDF"]
    first = int(root["Steps/PointOffsets"][index])
    rows = slice(first, first + int(root["NumberOfPoints"][index]))
    return Frame(
        step=int(file["frames/step"][index]),
        time=float(root["Steps/Values"][index]),
        load_factor=float(file["frames/load_factor"][index]),
        position=root["Points"][rows],
        data={name: data[rows] for name, data in root["PointData"].items()},
        boundaries=_boundaries(file["boundaries"], index),
        stations=_stations(file["stations"], index) if "stations" in file else None,
    )


def _stations(group: h5py.Group, index: int) -> Stations:
    first = int(group["first_row"][index])
    rows = slice(first, first + int(group["n_rows"][index]))
    return Stations(
        boundary=group["boundary"][rows],
        slip=group["slip"][rows],
        position=group["position"][rows],
        length=group["length"][rows],
        traction=group["traction"][rows],
    )


def _arc(first: np.ndarray, last: np.ndarray, bulge: float) -> np.ndarray:
    """Points along an arc after its first end."""
    chord = last - first
    left = np.array([-chord[1], chord[0]])
    centre = 0.5 * (first + last) + left * (1.0 - bulge**2) / (4.0 * bulge)
    angle = 4.0 * np.arctan(bulge)
    turns = np.linspace(0.0, angle, max(2, int(np.ceil(abs(angle) / 0.05)) + 1))[1:]
    arm = first - centre
    across = np.array([-arm[1], arm[0]])
    return centre + np.cos(turns)[:, None] * arm + np.sin(turns)[:, None] * across


def _boundaries(group: h5py.Group, index: int) -> list[Boundary]:
    ends, corners = group["offsets"][:], group["vertices"][index]
    bulges = group["bulges"][:] if "bulges" in group else np.zeros(len(corners))
    is_tool = group["is_tool"][:] if "is_tool" in group else np.zeros(len(ends) - 1)
    return [
        Boundary(
            _text(name), _text(kind), corners[first:last], bool(tool), bulges[first : last - 1]
        )
        for name, kind, tool, first, last in zip(
            group["name"], group["kind"], is_tool, ends[:-1], ends[1:], strict=True
        )
    ]


def _attributes(group: h5py.Group) -> dict[str, str]:
    return {name: _text(value) for name, value in group.attrs.items()}


def _text(value: bytes | str) -> str:
    return value.decode("utf-8", errors="replace") if isinstance(value, bytes) else str(value)
