"""Blades far thinner than a cell are drawn sideways through clay that is on both sides of them."""

import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_PROGRAM") or ROOT / "build/release/coulter").resolve()

SPACING = 0.25
#: The blade begins at x = 0 and goes four cells, for several places of the grid.
SCENE = """&scene title = "upright blade in clay" /
&grid origin = ORIGIN, -2.3, spacing = 0.25, cells = 30, 16 /
&law name = "clay", model = "tresca", youngs_modulus = 3000.0, poisson_ratio = 0.49, shear_strength = 10.0 /
&body name = "bed", law = "clay", density = 1.8 /
&region body = "bed", rectangle = -3.0, -2.0, 3.0, 0.0 /
&boundary name = "base", kind = "fixed", vertices = -3.2, -2.0, 3.2, -2.0 /
&boundary name = "right", kind = "roller", vertices = 3.0, -2.2, 3.0, 1.0 /
&boundary name = "left", kind = "roller", vertices = -3.0, 1.0, -3.0, -2.2 /
&tool name = "blade", shape = "rectangle", size = THICKNESS, 1.5, position = 0.0, -1.0, embedded = .true.
   displacement = 1.0, 0.0 /
&steps count = 20 /
"""


def draw(thickness: float, origin: float, folder: Path) -> np.ndarray:
    """Force on a blade in every step of a run that goes to its end."""
    folder.mkdir()
    text = SCENE.replace("ORIGIN", str(origin)).replace("THICKNESS", str(thickness))
    (folder / "s.nml").write_text(text)
    command = [str(PROGRAM), "--quiet", "--output", str(folder), str(folder / "s.nml")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with h5py.File(folder / "s.vtkhdf") as file:
        rows = file["history"].attrs["n_rows"]
        assert file["history/penetrations"][:rows].max() <= 0.02 * SPACING
        return np.abs(file["history/boundary_reactions"][:rows, -1, 0])


@pytest.mark.parametrize("origin", [-3.46, -3.36, -3.263])
def test_blade_of_a_fifth_of_a_cell_takes_what_one_of_nearly_a_cell_does(origin, tmp_path):
    thin = draw(0.2 * SPACING, origin, tmp_path / "thin")
    thick = draw(0.8 * SPACING, origin, tmp_path / "thick")
    # 19, 4 and 3 % more: new tiles at the ends of blades are as coarse as cells
    assert thin.mean() == pytest.approx(thick.mean(), rel=0.25)
