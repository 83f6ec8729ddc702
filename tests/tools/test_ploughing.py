"""The first part of every example whose tools go far: nothing gets into them and they get into
nothing, no material is lost, they rub no more than they may, and forces on the bodies balance.
"""
import os
import re
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_EXE") or os.environ.get("COULTER_PROGRAM")
               or ROOT / "build/release/coulter").resolve()


def shorten(text, n):
    """The first n steps of a deck whose tool moves evenly."""
    count = int(re.search(r"&steps count = (\d+)", text)[1])
    way = [float(x) for x in re.search(r"displacement = (\S+), ([^,\s/]+)", text).groups()]
    text = text.replace(f"count = {count}", f"count = {n}")
    part = ", ".join(repr(x * n / count) for x in way)
    return re.sub(r"displacement = \S+, [^,\s/]+", f"displacement = {part}", text)


def run(folder, path, n):
    """Run a part of a deck; history of its last boundary, the tool, and the mass in every frame."""
    deck = folder / Path(path).name
    text = (ROOT / "input" / path).read_text()
    deck.write_text(shorten(text, n))
    subprocess.run([PROGRAM, "--quiet", "--output", folder, deck], check=True)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        rows = file["history"].attrs["n_rows"]
        history = {name: data[:rows] for name, data in file["history"].items()
                   if data.shape and data.shape[0] >= rows}
        resets = {name: file["history"][name][:] for name in (
            "reset_rows", "reset_residuals", "reset_force_changes")}
        points = file["VTKHDF/PointData"]
        rows_of = [slice(a, a + m) for a, m in zip(file["VTKHDF/Steps/PointOffsets"],
                                                   file["VTKHDF/NumberOfPoints"], strict=True)]
        masses = [(points["volume"][k] / points["volume_ratio"][k]).sum() for k in rows_of]
    spacing = float(re.search(r"spacing = ([\d.]+)", text)[1])
    assert (resets["reset_rows"] == np.flatnonzero(history["has_retiled"])).all()
    assert (resets["reset_residuals"] > 0.0).all()
    assert np.isfinite(resets["reset_force_changes"]).all()
    return history, np.array(masses), spacing


# where soil parts, a tip is in the tile that hangs on both sides, until new ones come (docs/stability.md)
CUT = 0.75


@pytest.mark.parametrize(("path", "n", "friction", "limit", "tips"), [
    ("plough/plough.nml", 20, 0.2, np.inf, CUT),
    ("plough/share.nml", 20, 0.2, 5.0, CUT),
    ("plough/sand.nml", 10, 0.3, np.inf, CUT),
    ("pipe/rough.nml", 12, np.inf, 1.0, 0.0),
    ("pipe/penetration.nml", 12, 0.0, 0.0, 0.0),
    ("indentation/wedge.nml", 20, 0.0, 0.0, 0.02),
])
def test_tools_stay_outside(tmp_path, path, n, friction, limit, tips):
    history, masses, spacing = run(tmp_path, path, n)
    assert history["has_retiled"].sum() >= 1
    assert history["penetrations"].max() <= 0.02 * spacing
    assert history["tip_penetrations"].max() <= tips * spacing
    assert masses == pytest.approx(masses[0], rel=1e-9)
    force = np.abs(history["boundary_reactions"]).max()
    assert np.abs(history["imbalance"]).max() <= 1e-7 * force
    # the tool is the last boundary
    rubbing, pressing, length = (history[name][:, -1] for name in (
        "rubbing_forces", "pressing_forces", "loaded_lengths"))
    slack = 1e-9 * force
    assert (pressing > 0.0).all()
    if np.isfinite(friction):
        assert (rubbing <= friction * pressing + slack).all()
    if np.isfinite(limit):
        assert (rubbing <= limit * length + slack).all()
    assert (rubbing.max() > 0.0) == (limit > 0.0)
