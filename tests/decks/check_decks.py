"""Every deck of input/ does what it says. Nothing gets into tools and walls, no material is lost,
forces balance, and what goes far is tiled anew and rubs no more than it may; what is meant to fail
fails with its message.

ctest has a row for every folder of input/ (tests/CMakeLists.txt); a new deck is found by itself.
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
DECKS = sorted((ROOT / "input").glob("*/*.nml"))

#: Decks that take long run so many steps only.
MOST_STEPS = {"pipe/penetration": 40, "pipe/rough": 30}
#: How decks end that are meant to fail.
FAILURES = {"wedge/paper_20_degrees": r"step [2-5] of 6 failed .*: the tangent is singular: the material is unstable"}
#: Friction and largest shear of tools that go far.
RUBBING = {"plough/plough": (0.2, np.inf), "plough/share": (0.2, 5.0), "plough/sand": (0.3, np.inf),
           "pipe/rough": (np.inf, 1.0), "pipe/penetration": (0.0, 0.0), "indentation/wedge": (0.0, 0.0)}
#: Ends of a face that new tiles move, where it is not one: the lip before a wedge rises with it.
N_ENDS = {"indentation/wedge": 2}
#: Depths over the spacing of what may get into what, where it is not .02: the paper's method knows
#: points only, and corners give beside the bucket in four of its steps, beside the sled, with some
#: round-off, in one.
DEPTHS = {"wedge/paper": 0.1, "bucket/bucket": 0.125, "hinge/hinge": 0.025}
#: The same for corners of tools in bodies: one of the bucket, which turns, is 0.046 in after one step
#: with some round-off, in which new tiles bring no root to the cut before it.
TIPS = {"bucket/bucket": 0.1}


def run(deck, folder, n_steps):
    """Run a deck, or its first steps."""
    steps = ["--steps", str(n_steps)] if n_steps else []
    return subprocess.run([PROGRAM, "--output", folder, *steps, deck],
                          capture_output=True, text=True, check=False)


def read(folder):
    """History of a run, how it ended, and the mass in every frame."""
    [path] = folder.glob("*.vtkhdf")
    with h5py.File(path) as file:
        rows = file["history"].attrs["n_rows"]
        history = {name: data[:rows] for name, data in file["history"].items()
                   if data.shape and data.shape[0] >= rows}
        history |= {name: file["history"][name][:] for name in (
            "reset_rows", "reset_residuals", "reset_force_changes")}
        points = file["VTKHDF/PointData"]
        rows_of = [slice(a, a + m) for a, m in zip(file["VTKHDF/Steps/PointOffsets"],
                                                   file["VTKHDF/NumberOfPoints"], strict=True)]
        masses = [(points["volume"][k] / points["volume_ratio"][k]).sum() for k in rows_of]
        return history, file["provenance"].attrs["status"], np.array(masses)


def check_resets(history, n_ends, spacing):
    """New tiles have come, and the history says what they change: with their first step the force of
    the tool, the last boundary, by no more than a cell at an end of its face carries, and what it has
    got or lost in contact meanwhile. Faces of less than two cells are left out."""
    rows, changes = history["reset_rows"], history["reset_force_changes"]
    assert len(rows) >= 1
    assert (rows == np.flatnonzero(history["has_retiled"])).all()
    assert (history["reset_residuals"] > 0.0).all()
    forces, lengths = history["boundary_reactions"][:, -1], history["loaded_lengths"][:, -1]
    if rows[-1] == len(forces) - 1:  # no step has followed
        assert np.isnan(changes[-1]).all()
        rows, changes = rows[:-1], changes[:-1]
    assert changes[:, -1] == pytest.approx(forces[rows + 1] - forces[rows])
    is_long = lengths[rows] > 2.0 * spacing
    rows, changes = rows[is_long], np.linalg.norm(changes[is_long, -1], axis=1)
    share = (n_ends * spacing + np.abs(lengths[rows + 1] - lengths[rows])) / lengths[rows + 1]
    assert (changes <= share * np.linalg.norm(forces[rows + 1], axis=1)).all()


def check_rubbing(history, friction, limit):
    """The tool, the last boundary, presses all the time and rubs no more than it may."""
    rubbing, pressing, length = (history[name][:, -1] for name in (
        "rubbing_forces", "pressing_forces", "loaded_lengths"))
    slack = 1e-9 * np.abs(history["boundary_reactions"]).max()
    assert (pressing > 0.0).all()
    if np.isfinite(friction):
        assert (rubbing <= friction * pressing + slack).all()
    if np.isfinite(limit):
        assert (rubbing <= limit * length + slack).all()
    assert (rubbing.max() > 0.0) == (limit > 0.0)


@pytest.mark.parametrize("deck", DECKS, ids=lambda deck: f"of_{deck.parent.name}_{deck.stem}")
def test_deck(tmp_path, deck):
    name = f"{deck.parent.name}/{deck.stem}"
    text = deck.read_text()
    if "&sample" in text:
        subprocess.run([PROGRAM, "point", "--quiet", "--output", tmp_path, deck], check=True)
        return
    result = run(deck, tmp_path, MOST_STEPS.get(name))
    history, status, masses = read(tmp_path)
    if name in FAILURES:
        assert result.returncode == 1
        assert re.search(FAILURES[name], result.stderr), result.stderr
        return
    assert result.returncode == 0, result.stderr
    assert status == b"finished"
    assert "cannot be trusted" not in result.stdout
    assert masses == pytest.approx(masses[0], rel=1e-9)
    spacing = float(re.search(r"spacing = ([\d.]+)", text)[1])
    assert history["penetrations"].max(initial=0.0) <= DEPTHS.get(name, 0.02) * spacing
    if "&contact" in text:
        assert history["surface_penetrations"].max() <= 0.02 * spacing
    assert history["tip_penetrations"].max(initial=0.0) <= TIPS.get(name, 0.02) * spacing
    forces = max(np.abs(history[f"{what}_reactions"]).max(initial=0.0)
                 for what in ("boundary", "fixity"))
    assert np.abs(history["imbalance"]).max() <= 1e-7 * forces
    if name in RUBBING:
        check_resets(history, N_ENDS.get(name, 1), spacing)
        check_rubbing(history, *RUBBING[name])
