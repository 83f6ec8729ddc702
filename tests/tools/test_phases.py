"""Phases of a deck show in the log and in the results, and displacements count anew after a rest."""
import os
import subprocess
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_EXE") or os.environ.get("COULTER_PROGRAM")
               or ROOT / "build/release/coulter").resolve()
DECK = ROOT / "input/rankine/passive.nml"


def rows(results, path, frame):
    count = int(results["VTKHDF/NumberOfPoints"][frame])
    first = int(results["VTKHDF/Steps/PointOffsets"][frame])
    return results[path][first:first + count]


def displacement(results, frame):
    return rows(results, "VTKHDF/PointData/displacement", frame)


def test_passive_wall_rests_first(tmp_path):
    run = subprocess.run([PROGRAM, "--output", tmp_path, DECK], capture_output=True, text=True,
                         check=True)
    lines = [line.strip() for line in run.stdout.splitlines()]
    assert lines.index("phase 1: rest") < lines.index("phase 2: push")
    assert any(line.endswith("in phases rest, push") for line in lines)
    with h5py.File(tmp_path / "passive.vtkhdf") as results:
        assert list(results["phases/name"].asstr()) == ["rest", "push"]
        assert list(results["phases/last_step"]) == [2, 12]
        n_rows = results["history"].attrs["n_rows"]
        steps = results["history/step"][:n_rows]
        assert np.array_equal(results["history/phase"][:n_rows], np.where(steps <= 2, 1, 2))
        # the floor gives way a little at rest; afterwards the wall drives all, 3 mm in a step
        assert 1e-7 < np.abs(displacement(results, 2)).max() < 1e-4
        assert np.abs(displacement(results, 3)).max() < 1.5 * 3e-3
        way = rows(results, "VTKHDF/Points", 12) - rows(results, "VTKHDF/Points", 2)
        assert np.abs(displacement(results, 12) - way).max() < 1e-12
        names = list(results["boundaries/name"].asstr())
        wall = results["history/boundary_displacements"][:n_rows, names.index("wall"), 0]
        assert np.allclose(wall[steps <= 2], 0.0, atol=0.0)
        assert np.isclose(wall[-1], 0.03)
