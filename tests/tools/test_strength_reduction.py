"""Factor of safety of a slope by strength reduction (scripts/strength_reduction.py).

The slope of input/slope is example 1 of Griffiths and Lane, Geotechnique 49 (1999) 387-403: 1.4 by
finite elements; Bishop and Morgenstern, Geotechnique 10 (1960) 129-150, have 1.38. The vertical cut
of clay stands up to gamma H/s_u = 3.776, here with a factor of 1.5. Asked for are 3 %.
"""
import importlib.util
import math
import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_EXE") or os.environ.get("COULTER_PROGRAM")
               or ROOT / "build/release/coulter").resolve()
CUT = (ROOT / "input/slope/vertical_cut.nml").read_text(encoding="utf-8")
DECK = (ROOT / "input/slope/slope.nml").read_text(encoding="utf-8")


@pytest.fixture(name="script", scope="module")
def load_script():
    path = ROOT / "scripts/strength_reduction.py"
    spec = importlib.util.spec_from_file_location("strength_reduction", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_strengths_are_divided(script):
    deck = "&law cohesion = 10.0, friction_angle=20 ! cohesion = 3\n dilation_angle = 1.0d1, k = 2 /\n"
    text, count = script.reduced(deck, 2.0)
    assert count == 3
    assert "cohesion = 5.0, " in text
    assert "! cohesion = 3" in text
    assert f"friction_angle={math.degrees(math.atan(math.tan(math.radians(20.0)) / 2.0))!r} " in text
    assert f"dilation_angle = {math.degrees(math.atan(math.tan(math.radians(10.0)) / 2.0))!r}, k = 2" in text


def test_slope_has_the_known_factor(script):
    low, high = script.find_factor(PROGRAM, DECK, 0.97 * 1.4, 1.03 * 1.4, 0.04)
    assert 0.97 * 1.4 <= low < high <= 1.03 * 1.4


def test_vertical_cut_has_the_known_factor(script):
    # loss of equilibrium
    low, high = script.find_factor(PROGRAM, CUT, 0.97 * 1.5, 1.03 * 1.5, 0.1)
    assert 0.97 * 1.5 <= low < high <= 1.03 * 1.5


def test_vertical_cut_on_a_coarse_grid(script):
    # before equilibrium is lost, displacements begin to grow: nearer to the known factor
    coarse = CUT.replace("spacing = 0.125, cells = 144, 136", "spacing = 0.25, cells = 72, 68")
    assert coarse != CUT
    low, high = script.find_factor(PROGRAM, coarse, 0.97 * 1.5, 1.03 * 1.5, 0.1, growth=2.0)
    assert 0.97 * 1.5 <= low < high <= 1.03 * 1.5


def test_wrong_bounds_are_told(script):
    with pytest.raises(SystemExit, match="stands at the factor 1.1"):
        script.find_factor(PROGRAM, DECK, 1.0, 1.1, 0.01)
