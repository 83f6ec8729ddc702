"""Scalar fields that can be drawn, by short names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .results import Frame


@dataclass(frozen=True)
class Field:
    """How a scalar is taken from a frame, and how it is called."""

    label: str
    source: str
    values: Callable[[np.ndarray], np.ndarray]

    def of(self, frame: Frame) -> np.ndarray:
        """Values at the points of a frame, (n,)."""
        if self.source not in frame.data:
            raise ValueError(f"no law of this run has a {self.label}")
        return self.values(frame[self.source])


def _component(index: int) -> Callable[[np.ndarray], np.ndarray]:
    return lambda data: data[:, index]


def _mises(stress: np.ndarray) -> np.ndarray:
    deviator = stress[:, :3] - stress[:, :3].mean(axis=1, keepdims=True)
    return np.sqrt(1.5 * (np.sum(deviator**2, axis=1) + 2.0 * np.sum(stress[:, 3:] ** 2, axis=1)))


#: Fields by name: ux, uy, u, sxx ... sxy, p, mises, exx ... exy, j, body, and state of laws.
FIELDS: dict[str, Field] = {
    "ux": Field("x-displacement", "displacement", _component(0)),
    "uy": Field("y-displacement", "displacement", _component(1)),
    "u": Field("displacement", "displacement", lambda data: np.linalg.norm(data, axis=1)),
    "p": Field(
        "mean pressure, compression positive", "stress", lambda data: -data[:, :3].mean(axis=1)
    ),
    "mises": Field("von Mises stress", "stress", _mises),
    "j": Field("volume ratio J", "volume_ratio", lambda data: data),
    "body": Field("body", "body", lambda data: data.astype(float)),
    "plastic": Field("plastic strain", "plastic_strain", lambda data: data),
    "pore": Field("excess pore pressure", "excess_pore_pressure", lambda data: data),
}
for _index, _name in enumerate(("xx", "yy", "zz", "xy")):
    FIELDS["s" + _name] = Field(
        f"Cauchy stress {_name}, tension positive", "stress", _component(_index)
    )
    FIELDS["e" + _name] = Field(f"logarithmic elastic strain {_name}", "strain", _component(_index))
