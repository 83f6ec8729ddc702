"""Tools that are embedded in a body: the deck needs no region that leaves out their place."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from coulter_post import Results

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).resolve().parents[2]))
PROGRAM = os.environ.get("COULTER_PROGRAM", SOURCE / "build/release/coulter")

BED = """&scene title = "a blade in clay" /
&grid origin = -4.0, -4.0, spacing = 0.25, cells = 48, 24 /
&law name = "clay", model = "tresca"
   youngs_modulus = 500.0, poisson_ratio = 0.45, shear_strength = 1.0 /
&body name = "bed", law = "clay", density = 0.0 /
&boundary name = "base", kind = "fixed", vertices = -4.0, -3.0, 7.0, -3.0 /
&boundary name = "far side", kind = "roller", bilateral = .true.
   vertices = 6.0, -3.5, 6.0, 1.0 /
&steps count = 4 /
"""
BLADE = """&tool name = "blade", shape = "rectangle", size = 0.3, 3.0, position = -0.15, -1.0
   displacement = 0.2, 0.0, friction = 0.2"""
CUT = """&region body = "bed", polygon = -3.0, -3.0, 6.0, -3.0, 6.0, 0.0, 0.0, 0.0, 0.0, -1.0
   -0.3, -1.0, -0.3, 0.0, -3.0, 0.0 /
"""
WHOLE = '&region body = "bed", rectangle = -3.0, -3.0, 6.0, 0.0 /\n'


def run(deck: str, name: str, folder: Path) -> Results:
    """Results of a run that must succeed."""
    path = folder / f"{name}.nml"
    path.write_text(deck)
    subprocess.run([PROGRAM, "--quiet", "--output", folder, path], check=True)
    return Results(path.with_suffix(".vtkhdf"))


def test_blade_feels_what_it_does_in_a_hand_cut_bed(tmp_path):
    by_hand = run(BED + CUT + BLADE + " /\n", "by_hand", tmp_path)
    embedded = run(BED + WHOLE + BLADE + ", embedded = .true. /\n", "embedded", tmp_path)
    force = by_hand.history["boundary_reactions"]
    assert np.abs(embedded.history["boundary_reactions"] - force).max() < 1e-6 * np.abs(force).max()
    for results in (by_hand, embedded):
        assert results.frame(0)["volume"].sum() == pytest.approx(27.0 - 0.3, rel=1e-12)


def test_pipe_is_a_hole_in_the_ground(tmp_path):
    results = run((SOURCE / "input/pipe/uplift.nml").read_text(), "uplift", tmp_path)
    # the hole has chords, no deeper in the pipe than a fiftieth of the spacing
    hole = 18.0 - results.frame(0)["volume"].sum()
    assert np.pi * (0.5 - 0.02 * 0.125) ** 2 < hole < np.pi * 0.25
    history = results.history
    force = history["boundary_reactions"][:, 3]
    # less than a block between vertical planes, more than three quarters of it
    assert (force[2:, 1] < 25.0).all()
    assert (force[2:, 1] > 0.75 * 25.0).all()
    assert np.abs(force[:, 0]).max() < 0.01 * force[:, 1].max()
    assert history["penetrations"].max() < 0.02 * 0.125
