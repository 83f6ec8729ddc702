"""A run that fails says where, and what may help."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_PROGRAM") or ROOT / "build/release/coulter").resolve()

SCENE = """&scene title = "block" /
&grid origin = -2.0, -2.0, spacing = 0.25, cells = 24, 24 /
&law name = "elastic", model = "hencky", youngs_modulus = 1000.0, poisson_ratio = 0.3 /
&body name = "block", law = "elastic", density = 1.0 /
&region body = "block", rectangle = 0.0, 0.0, 1.0, 1.0 /
&body_force acceleration = 1.0, -10.0 /
&steps count = 2 /
"""
FLOOR = "&boundary name = 'floor', kind = 'roller', vertices = -1.0, 0.0, 3.0, 0.0 /\n"
PIN = "&fixity name = 'pin', lower = -0.1, -0.1, upper = 0.1, 0.1, held = 'xy' /\n"
BED = """&body name = "bed", law = "elastic", density = 1.0 /
&region body = "bed", rectangle = -1.0, -1.0, 2.0, 0.0 /
&boundary name = "base", kind = "fixed", vertices = -2.0, -1.0, 3.0, -1.0 /
&contact body = "bed", against = "block" /
"""
BANK = """&scene title = "a bank that is too high" /
&grid origin = -2.0, -2.0, spacing = 0.5, cells = 20, 16 /
&law name = "clay", model = "tresca"
   youngs_modulus = 2000.0, poisson_ratio = 0.45, shear_strength = 10.0 /
&body name = "bank", law = "clay", density = 60.0 /
&region body = "bank", polygon = 0.0, -1.0, 6.0, -1.0, 6.0, 0.0, 3.0, 0.0, 3.0, 3.0, 0.0, 3.0 /
&boundary name = "base", kind = "fixed", vertices = -1.0, -1.0, 7.0, -1.0 /
&boundary name = "left", kind = "roller", bilateral = .true., vertices = 0.0, 4.0, 0.0, -1.5 /
&boundary name = "right", kind = "roller", bilateral = .true., vertices = 6.0, -1.5, 6.0, 4.0 /
&body_force acceleration = 0.0, -1.0 /
&control max_halvings = 2 /
&steps count = 5 /
"""


def failure(deck: str, folder: Path) -> str:
    """Message of a run that must fail."""
    path = folder / "scene.nml"
    path.write_text(deck)
    done = subprocess.run(
        [PROGRAM, "--quiet", path], capture_output=True, text=True, check=False, cwd=folder
    )
    assert done.returncode == 1, done.stderr
    return done.stderr


@pytest.mark.parametrize(
    ("addition", "way"),
    [
        ("", "is free to move: nothing holds it;"),
        (FLOOR, "is free to move along (1, 0);"),
        (PIN, "is free to turn about (0, 0);"),
        (BED, "is free to move along (1, 0);"),
        (BED.replace("0.0 /", "-0.5 /"), "is free to move: nothing holds it;"),
    ],
)
def test_free_bodies_are_named(addition, way, tmp_path):
    assert f"the tangent is singular: body block {way}" in failure(SCENE + addition, tmp_path)


def test_bodies_that_stick_to_others_are_held(tmp_path):
    path = tmp_path / "scene.nml"
    path.write_text(SCENE + BED.replace('"block" /', '"block", friction = 0.3 /'))
    subprocess.run([PROGRAM, "--quiet", path], check=True, cwd=tmp_path)


def test_limit_loads_are_placed(tmp_path):
    message = failure(BANK, tmp_path)
    assert "forces are least in balance in body bank near (" in message
    assert "limit load: try more `max_iterations`; else load it less, or let it slide to where it rests" in message
