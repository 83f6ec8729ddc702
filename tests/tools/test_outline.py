"""Outlines of tools from drawings, read by the program."""
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_EXE") or os.environ.get("COULTER_PROGRAM")
               or ROOT / "build/release/coulter").resolve()
DRAWINGS = Path(__file__).with_name("drawings")
sys.path.insert(0, str(ROOT / "postproc"))

from coulter_post.__main__ import main  # noqa: E402


def convert(path, *options, drawing="share.dxf"):
    assert main(["outline", str(DRAWINGS / drawing), "-o", str(path), *options]) == 0
    return np.loadtxt(path, delimiter=",", comments="#")


def area(points):
    x, y = points.T
    return 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))


def test_lines_and_arc_are_joined(tmp_path):
    # 40 mm wide, 30 mm high, with half a circle of radius 20 mm on top
    points = convert(tmp_path / "share.csv", "--layer", "share", "--unit", "m",
                     "--tolerance", "1e-6")
    assert area(points) == pytest.approx(1.2e-3 + 0.5 * np.pi * 4e-4, rel=2e-4)
    for corner in ([0, 0], [0.04, 0], [0.04, 0.03], [0, 0.03], [0.02, 0.05]):
        assert np.hypot(*(points - corner).T).min() < 1e-9
    top = points[points[:, 1] > 0.03]
    assert np.allclose(np.hypot(*(top - [0.02, 0.03]).T), 0.02, rtol=1e-5)


def test_tolerance_bounds_the_chords(tmp_path):
    # sagitta of a chord of n in a circle of radius 10
    for tolerance in (0.5, 0.02):
        n = len(convert(tmp_path / "pipe.csv", "--layer", "pipe", "--tolerance", str(tolerance)))
        assert 10 * (1 - np.cos(np.pi / n)) <= tolerance
        # scaled after the flattening
        scaled = convert(tmp_path / "pipe.csv", "--layer", "pipe", "--scale", "0.1",
                         "--tolerance", str(0.1 * tolerance))
        assert len(scaled) == n
        assert np.ptp(scaled, axis=0) == pytest.approx([2, 2])


def test_svg_is_turned_over_and_measured(tmp_path):
    # 40 x 30 with a corner of a Bezier curve, moved by (10, 40) in a picture of 100 mm
    points = convert(tmp_path / "share.csv", "--layer", "share", "--unit", "mm",
                     drawing="share.svg")
    assert points.min(axis=0) == pytest.approx([10, -40])
    assert points.max(axis=0) == pytest.approx([50, -10])
    # beside the curve's chord: 20 x 10 less what a cubic with these handles cuts off
    t = np.linspace(0, 1, 20001)[:, None]
    handles = [[50, -20], [50, -10], [40, -10], [30, -10]]
    curve = sum(c * (1 - t) ** (3 - k) * t**k * np.array(p)
                for k, (c, p) in enumerate(zip((1, 3, 3, 1), handles)))
    exact = area(np.concatenate([[[10, -40], [50, -40]], curve, [[10, -10]]]))
    assert area(points) == pytest.approx(exact, rel=1e-3)
    blade = convert(tmp_path / "blade.csv", "--layer", "blade", "--unit", "cm",
                    drawing="share.svg")
    assert blade == pytest.approx(np.array([[0, -4.5], [4, -4.5], [6, -4.8]]))


def test_program_reads_the_table(tmp_path):
    convert(tmp_path / "share.csv", "--layer", "share", "--scale", "0.05")
    (tmp_path / "share.nml").write_text("""
&grid origin = -2, -3, spacing = 0.5, cells = 12, 12 /
&law name = "soil", youngs_modulus = 1000, poisson_ratio = 0.3 /
&body name = "bed", law = "soil", density = 1 /
&region body = "bed", rectangle = -1, -2, 3, 0 /
&boundary name = "base", kind = "fixed", vertices = -1, -2, 3, -2 /
&tool name = "share", shape = "polygon", file = "share.csv", displacement = 0, -0.1 /
&steps count = 2 /
""")
    subprocess.run([PROGRAM, "--quiet", "--output", tmp_path, tmp_path / "share.nml"], check=True)
    table = np.genfromtxt(tmp_path / "share_tools.csv", delimiter=",", names=True)
    # confined below the middle of the share: more than free compression, less than all confined
    assert 1000 * 0.05 * 2 < -table["shareforce_y"][-1] < 1346 * 0.06 * 4


@pytest.mark.parametrize(("arguments", "message"), [
    (["share.dxf"], "holds 3 outlines, choose one by --layer or --number"),
    (["share.dxf", "--layer", "plough"], "no layer 'plough'; known are blade, notes, pipe, share"),
    (["share.dxf", "--layer", "notes"], "no lines or curves in layer 'notes'"),
    (["share.svg", "--number", "4"], "holds 3 outlines"),
    (["share.svg", "--tolerance", "0"], "tolerance must be > 0"),
    (["share.dxf", "--scale", "-1"], "scale must be > 0"),
    (["none.dxf"], "no such file"),
    (["../test_outline.py"], "known are DXF and SVG"),
])
def test_faults_are_told_in_one_line(arguments, message, tmp_path, capsys):
    drawing, *options = arguments
    path = tmp_path / "tool.csv"
    assert main(["outline", str(DRAWINGS / drawing), "-o", str(path), *options]) == 1
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert message in line
    assert not path.exists()


@pytest.mark.parametrize(("suffix", "library"), [("dxf", "ezdxf"), ("svg", "svgelements")])
def test_missing_library_is_named(suffix, library, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)
    assert main(["outline", str(DRAWINGS / f"share.{suffix}"), "-o", str(tmp_path / "t.csv")]) == 1
    assert f"pip install {library}" in capsys.readouterr().err


def test_what_is_no_drawing_is_refused(tmp_path, capsys):
    for name in ("tool.dxf", "tool.svg"):
        (tmp_path / name).write_text("no drawing")
        assert main(["outline", str(tmp_path / name)]) == 1
        assert "is no" in capsys.readouterr().err
