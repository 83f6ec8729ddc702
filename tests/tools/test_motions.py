"""Several tools in one scene: ways that bend from phase to phase, a wave, velocities, a load; tools
that meet the bed, leave it and come back."""
import csv
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_EXE") or os.environ.get("COULTER_PROGRAM")
               or ROOT / "build/release/coulter").resolve()

DECK = """
&scene title = "three tools on a bed" /
&grid origin = -4, -3, spacing = 0.25, cells = 40, 22 /
&law name = "soil", youngs_modulus = 1000, poisson_ratio = 0.3 /
&body name = "bed", law = "soil", density = 1 /
&region body = "bed", rectangle = -3, -2, 5, 0 /
&boundary name = "base", kind = "fixed", vertices = -3.5, -2, 5.5, -2 /
&boundary name = "left", kind = "roller", vertices = -3, 1, -3, -2.5 /
&boundary name = "right", kind = "roller", vertices = 5, -2.5, 5, 1 /
&tool name = "share", shape = "rectangle", size = 0.5, 1.5, position = -1.5, 0.05, rounding = 0.1, friction = 0.2 /
&tool name = "pipe", shape = "circle", radius = 0.5, position = 2.5, 0.55, free = "y", load = 0, -8 /
&tool name = "probe", shape = "rectangle", size = 0.5, 1.0, position = 4.0, 0.06, rounding = 0.1 /
&phase name = "sink", count = 6 /
&phase name = "drag", count = 12, duration = 2 /
&phase name = "hold", count = 2 /
&phase name = "lift", count = 4 /
&motion tool = "share", phase = "sink", displacement = 0, -0.15 /
&motion tool = "share", phase = "drag", velocity = 0.15, 0 /
&motion tool = "share", phase = "lift", displacement = 0, 0.6 /
&motion tool = "probe", table = "hop", displacement = 0, -0.12 /
&motion tool = "probe", phase = "drag", rotation_rate = 2 /
&table name = "hop", time = 0.0, 4.0, value = 1, 1, period = 2.0 /
"""


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    folder = tmp_path_factory.mktemp("motions")
    (folder / "tools.nml").write_text(DECK)
    subprocess.run([PROGRAM, "--quiet", "--output", folder, folder / "tools.nml"], check=True)
    with (folder / "tools_tools.csv").open() as table:
        rows = [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(table)]
    return [row for row in rows if row["is_complete"]]


def test_every_tool_goes_its_way(rows):
    assert len(rows) == 24
    for row in rows:
        t = row["time"]
        dragged = np.clip(t - 1, 0, 2)
        lifted = np.clip(t - 4, 0, 1)
        assert row["share:pivot_x"] == pytest.approx(-1.5 + 0.15 * dragged)
        assert row["share:pivot_y"] == pytest.approx(0.05 - 0.15 * min(t, 1) + 0.6 * lifted)
        assert row["probe:pivot_y"] == pytest.approx(0.06 - 0.12 * np.sin(np.pi * t), abs=1e-12)
        assert row["probe:rotation"] == pytest.approx(np.radians(2 * dragged))


def test_forces_come_and_go_with_the_contacts(rows):
    force = {row["step"]: row for row in rows}
    for row in rows:
        # forces on the bed; the pipe carries its load, which grows over the first phase
        assert row["pipe:force_y"] == pytest.approx(-8 * min(row["time"], 1), rel=1e-6)
        meets = row["probe:pivot_y"] < -0.02
        assert (row["probe:force_y"] < -5) == meets
        for tool in ("share", "pipe", "probe"):
            assert row[f"{tool}:penetration"] < 0.02 * 0.25
            # arcs of a radius of 0.4 spacings pass between the corners of the bed: docs/stability.md
            assert row[f"{tool}:tip_penetration"] < 0.3 * 0.25
    # held, the share feels the same; lifted, nothing
    for axis in "xy":
        held = [force[step][f"share:force_{axis}"] for step in (18, 19, 20)]
        assert held == pytest.approx([held[0]] * 3, rel=2e-3)
        assert [force[step][f"share:force_{axis}"] for step in (21, 22, 23, 24)] == [0] * 4
