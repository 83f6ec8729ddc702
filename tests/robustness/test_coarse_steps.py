"""Steps that are far too large end well: they are halved, and what tools have done in the end hangs
little on them. Where no step is small enough, since a free tool snaps through, it settles."""

import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_PROGRAM") or ROOT / "build/release/coulter").resolve()

SCENE = """&scene title = "three tools in one bed" /
&grid origin = -5.0, -4.0, spacing = 0.25, cells = 56, 28 /
&law name = "clay", model = "tresca"
   youngs_modulus = 500.0, poisson_ratio = 0.45, shear_strength = 1.0 /
&body name = "bed", law = "clay", density = 0.0 /
&region body = "bed", rectangle = -4.0, -3.0, 8.0, 0.0 /
&boundary name = "base", kind = "fixed", vertices = -5.0, -3.0, 9.0, -3.0 /
&boundary name = "right", kind = "roller", bilateral = .true., vertices = 8.0, -3.5, 8.0, 1.0 /
&boundary name = "left", kind = "roller", bilateral = .true., vertices = -4.0, 1.0, -4.0, -3.5 /
&tool name = "blade", shape = "rectangle", size = 0.3, 3.0, position = -0.15, -0.75
   embedded = .true., displacement = 1.8, 0.0, friction = 0.2 /
&tool name = "footing", shape = "rectangle", size = 1.2, 1.0, position = 5.5, 0.0
   displacement = 0.0, -0.9 /
&tool name = "pipe", shape = "circle", radius = 0.5, position = -2.4, 0.5
   displacement = 0.0, -0.9, friction = 0.3, shear_limit = 0.5 /
&steps count = 10 /
"""
#: Work of the tools with 64 steps of 0.11 cells, none of which is halved. In 10, 16 and 32 steps the
#: blade, three cells deep, does 4.10 to 4.30, with the kinds of round-off too.
WORKS = [4.057, 6.152, 4.009]
#: A block that only friction holds on a plate that turns by 7.5 degrees in a step.
BLOCK = """&grid origin = -3.0, -3.0, spacing = 0.25, cells = 28, 28 /
&law name = "rubber", youngs_modulus = 1000.0, poisson_ratio = 0.3 /
&body name = "block", law = "rubber", density = 1.0 /
&region body = "block", rectangle = 0.0, 0.0, 1.0, 1.0 /
&body_force acceleration = 0.0, -1.0, from_start = .true. /
&tool name = "plate", shape = "polygon", vertices = -0.5, -0.5, 1.5, -0.5, 1.5, 0.0, -0.5, 0.0
   rotation = 30.0, pivot = 0.5, -0.25, friction = 0.9 /
&steps count = 4 /
"""
#: A plate that hangs from a hinge and is towed over clay: it digs in and flips out.
PLATE = """&grid origin = -2.0, -3.0, spacing = 0.25, cells = 48, 24 /
&law name = "clay", model = "von_mises"
   youngs_modulus = 1000.0, poisson_ratio = 0.45, yield_stress = 17.32 /
&body name = "bed", law = "clay", density = 0.0 /
&region body = "bed", rectangle = -1.0, -2.0, 9.0, 0.0 /
&boundary name = "base", kind = "fixed", vertices = -2.0, -2.0,  10.0, -2.0 /
&boundary name = "right", kind = "roller", bilateral = .true., vertices = 9.0, -2.5,  9.0, 1.0 /
&boundary name = "left", kind = "roller", bilateral = .true., vertices = -1.0, 1.0,  -1.0, -2.5 /
&tool name = "plate", shape = "rectangle", size = 0.5, 1.8, angle = -45.0, position = 1.0, 0.2
   pivot = 2.2, 1.4, free_rotation = .true., friction = 0.2
   load = 0.0, -30.0, load_point = 1.64, 0.84 /
&motion tool = "plate", phase = "tow", displacement = 3.0, 0.0 /
&phase name = "sink", count = 10 /
&phase name = "tow", count = 60, duration = 3.0 /
"""


def run(scene: str, folder: Path, *options: str) -> dict:
    """History of a run that reaches its end."""
    deck = folder / "scene.nml"
    deck.write_text(scene)
    subprocess.run([PROGRAM, "--quiet", *options, deck], check=True, cwd=folder)
    with h5py.File(folder / "scene.vtkhdf") as file:
        rows = file["history"].attrs["n_rows"]
        return {name: file[f"history/{name}"][:rows]
                for name in ("works", "penetrations", "n_settling", "boundary_reactions",
                             "rubbing_forces", "moments", "rotations", "phase")}


def test_three_tools_in_steps_of_most_of_a_cell(tmp_path):
    history = run(SCENE, tmp_path)
    # corners give beside the blade and the footing, in steps of 0.72 and 0.36 cells, as round-off has it
    assert history["penetrations"][:, 3:5].max() <= 0.36 * 0.25
    assert np.delete(history["penetrations"], [3, 4], axis=1).max() <= 0.02 * 0.25
    assert history["n_settling"].max() == 0
    assert history["works"][-1, 3:] == pytest.approx(WORKS, rel=0.07)


def test_three_tools_in_steps_of_a_tenth_of_a_cell(tmp_path):
    history = run(SCENE.replace("count = 10", "count = 64"), tmp_path)
    assert len(history["works"]) == 64
    assert history["penetrations"].max() <= 0.02 * 0.25
    assert history["works"][-1, 3:] == pytest.approx(WORKS, rel=0.02)


def test_block_turns_with_the_plate_that_it_sticks_to(tmp_path):
    history = run(BLOCK, tmp_path)
    assert history["penetrations"].max() <= 0.02 * 0.25
    # its weight is 1
    assert history["boundary_reactions"][-1, 0] == pytest.approx([0.0, 1.0], abs=1e-7)
    assert history["rubbing_forces"][-1, 0] == pytest.approx(np.sin(np.radians(30.0)), abs=1e-6)


def test_hinged_plate_settles_where_it_snaps_through(tmp_path):
    history = run(PLATE, tmp_path, "--steps", "22")
    assert history["penetrations"].max() <= 0.02 * 0.25
    settling = history["n_settling"] > 0
    assert settling.any()
    # moments about the hinge, of the load and of the soil, at rest: no drag is left
    angle = history["rotations"][:, -1]
    moment = -30.0 * 0.56 * (np.sin(angle) - np.cos(angle))
    rest = (history["phase"] == 2) & ~(settling & np.append(settling[1:], False))
    assert history["moments"][rest, -1] == pytest.approx(moment[rest], rel=1e-6)
