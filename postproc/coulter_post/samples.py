"""Tests on samples: the tables that `coulter point` writes, and their figure."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .figures import GRID_COLOUR, STYLE


class Sample:
    """Columns of one table by their names; pressure `p` is positive in compression."""

    def __init__(self, path: Path) -> None:
        self.path = Path(path)
        self.name = self.path.stem
        with self.path.open(encoding="utf-8") as file:
            self.columns = file.readline().strip().split(",")
            self._values = np.loadtxt(file, delimiter=",", ndmin=2)
        if "stress_xx" not in self.columns:
            raise ValueError(f"{path}: is no table of coulter point")

    def __contains__(self, column: str) -> bool:
        return column in self.columns

    def __getitem__(self, column: str) -> np.ndarray:
        return self._values[:, self.columns.index(column)]

    @property
    def is_sheared(self) -> bool:
        """Is it layers that shear, rather than an axis that shortens?"""
        return bool(np.ptp(self["strain_xy"]) > np.ptp(self["strain_yy"]))


def draw(samples: Sequence[Sample]) -> Figure:
    """Stress path, stress against strain, volume against strain and against pressure."""
    sheared = all(sample.is_sheared for sample in samples)
    along = "strain_xy" if sheared else "strain_yy"
    sign = 1.0 if sheared else -1.0
    strain = "shear strain" if sheared else "axial strain (compression positive)"
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.5, 6.0), layout="constrained")
        axes = figure.subplots(2, 2)
        for sample in samples:
            style = {"label": sample.name, "marker": "." if len(sample["p"]) < 12 else ""}
            axes[0, 0].plot(sample["p"], sample["q"], **style)
            stress = sample["stress_xy"] if sheared else sample["q"]
            axes[0, 1].plot(sign * sample[along], stress, **style)
            axes[1, 0].plot(sign * sample[along], sample["volume_strain"], **style)
            pressed = sample["p"] > 1.0e-9 * np.max(np.abs(sample["p"]), initial=0.0)
            axes[1, 1].plot(sample["p"][pressed], _volume(sample, samples)[pressed], **style)
        _label(axes[0, 0], "stress path", "mean pressure p", "von Mises stress q")
        _label(axes[0, 1], "stress", strain, "shear stress" if sheared else "q")
        _label(axes[1, 0], "volume", strain, "volume strain")
        axes[1, 1].set_xscale("log")
        volume = "void ratio e" if _has_void_ratio(samples) else "volume strain"
        _label(axes[1, 1], "compression", "mean pressure p", volume)
        if len(samples) > 1:
            axes[0, 1].legend()
    return figure


def _has_void_ratio(samples: Sequence[Sample]) -> bool:
    return all("void_ratio" in sample for sample in samples)


def _volume(sample: Sample, samples: Sequence[Sample]) -> np.ndarray:
    return sample["void_ratio" if _has_void_ratio(samples) else "volume_strain"]


def _label(panel: Axes, title: str, across: str, upward: str) -> None:
    panel.set(title=title, xlabel=across, ylabel=upward)
    panel.grid(color=GRID_COLOUR, linewidth=0.6)
