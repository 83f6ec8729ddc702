"""Tools that push, stop, recede and come back: soil unloads and loads again, lets go and meets again."""

import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_PROGRAM") or ROOT / "build/release/coulter").resolve()
SPACING = 0.25

#: A footing of width 2 on clay of strength 1: pushed in, lifted off, pushed in farther, pulled a little.
FOOTING = """&grid origin = -5.0, -3.0, spacing = 0.25, cells = 40, 20 /
&law name = "clay", model = "tresca", youngs_modulus = 500.0, poisson_ratio = 0.45, shear_strength = 1.0 /
&body name = "bed", law = "clay", density = 0.0 /
&region body = "bed", rectangle = -4.0, -2.0, 4.0, 0.0 /
&boundary name = "base", kind = "fixed", vertices = -5.0, -2.0, 5.0, -2.0 /
&boundary name = "left", kind = "roller", bilateral = .true., vertices = -4.0, 1.0, -4.0, -2.5 /
&boundary name = "right", kind = "roller", bilateral = .true., vertices = 4.0, -2.5, 4.0, 1.0 /
&tool name = "footing", shape = "rectangle", size = 2.0, 0.8, rough = .true., shear_limit = 1.0 EXTRA /
&motion tool = "footing", displacement = 0.0, -1.0, table = "way" /
&table name = "way", time = 0.0, 0.25, 0.5, 0.75, 1.0, value = 0.0, 0.15, -0.05, 0.2, 0.15 /
&steps count = 40 /
"""
#: A blade 1 deep in sand that is pushed against it, drawn away, and pushed again.
BLADE = """&grid origin = -2.0, -4.0, spacing = 0.25, cells = 40, 28 /
&law name = "sand", model = "mohr_coulomb", youngs_modulus = 5000.0, poisson_ratio = 0.3
   cohesion = 1.0, friction_angle = 30.0, dilation_angle = 10.0 /
&body name = "bed", law = "sand", density = 1.0, k0 = 0.5 /
&region body = "bed", rectangle = 0.0, -2.0, 7.0, 0.0 /
&body_force acceleration = 0.0, -10.0, from_start = .true. /
&boundary name = "base", kind = "fixed", vertices = -1.0, -2.0, 8.0, -2.0 /
&boundary name = "far", kind = "roller", bilateral = .true., vertices = 7.0, -2.5, 7.0, 1.0 /
&boundary name = "near", kind = "roller", bilateral = .true., vertices = 0.0, -1.0, 0.0, -2.5 /
&tool name = "blade", shape = "polygon", vertices = -0.5, -1.0, 0.0, -1.0, 0.0, 2.0, -0.5, 2.0
   friction = 0.3 /
&motion tool = "blade", displacement = 0.2, 0.0, table = "way" /
&table name = "way", time = 0.0, 0.25, 0.5, 0.75, 1.0, value = 0.0, 0.5, -0.1, 0.8, 0.6 /
&steps count = 40 /
"""
#: A blade goes away from sand 1 high that stands on an edge; half a metre below is a shelf.
EDGE = """&grid origin = -3.0, -4.0, spacing = 0.25, cells = 44, 28 /
&law name = "sand", model = "mohr_coulomb", youngs_modulus = 5000.0, poisson_ratio = 0.3
   cohesion = 1.0, friction_angle = 30.0, dilation_angle = 30.0 /
&body name = "bed", law = "sand", density = 1.0, k0 = 0.5 /
&region body = "bed", rectangle = 0.0, -2.0, 5.0, 0.0 /
&body_force acceleration = 0.0, -10.0, from_start = .true. /
&boundary name = "base", kind = "fixed", vertices = -1.0, -2.0, 6.0, -2.0 /
&boundary name = "far", kind = "roller", bilateral = .true., vertices = 5.0, -2.5, 5.0, 1.0 /
&boundary name = "shelf", kind = "roller", friction = 0.3, vertices = -2.5, -1.5, 0.0, -1.5 /
&boundary name = "near", kind = "roller", bilateral = .true., vertices = 0.0, -1.0, 0.0, -2.5 /
&tool name = "blade", shape = "polygon", vertices = -0.5, -1.0, 0.0, -1.0, 0.0, 2.0, -0.5, 2.0
   displacement = -0.5, 0.0, friction = 0.3 /
&steps count = 10 /
&control settle = .true. /
"""


def run(deck, folder):
    """History of a run that goes to its end, with no corner deeper than 0.02 of a cell in a tool."""
    (folder / "s.nml").write_text('&scene title = "to and fro" /\n' + deck)
    command = [str(PROGRAM), "--quiet", "--output", str(folder), str(folder / "s.nml")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    with h5py.File(folder / "s.vtkhdf") as file:
        rows = file["history"].attrs["n_rows"]
        history = {name: file[f"history/{name}"][:rows]
                   for name in ("time", "is_complete", "penetrations", "boundary_reactions")}
    # corners give in the step in which the blade begins to part the sand
    assert history["penetrations"][:, -1].max() <= 0.025 * SPACING
    assert np.sort(history["penetrations"][:, -1])[-2] <= 0.02 * SPACING
    return history


def force_at(history, time, component):
    return history["boundary_reactions"][np.searchsorted(history["time"], time - 1e-9), 3, component]


BEARING = (2.0 + np.pi) * 2.0


@pytest.mark.parametrize(("tension", "opening"), [(0.0, 0.0), (0.5, 0.0), (0.5, 0.02)])
def test_footing_lifts_off_and_comes_back(tmp_path, tension, opening):
    extra = f", tension_limit = {tension}, tension_opening = {opening}"
    history = run(FOOTING.replace("EXTRA", extra if tension > 0.0 else ""), tmp_path)
    # no step is halved
    assert len(history["time"]) == 40
    assert -force_at(history, 0.25, 1) == pytest.approx(BEARING, rel=0.05)
    # it hangs on the tension of its base, which fades within one step if it does, and on a strength of 1 on
    # lips of a third of a cell at most; then it is off the ground, which it meets again higher up
    pull = history["boundary_reactions"][:20, 3, 1].max()
    assert 2.0 * tension * (1.0 if opening == 0.0 else 0.3) <= pull <= 2.0 * tension + 0.17
    assert force_at(history, 0.5, 1) == pytest.approx(0.0, abs=1e-8)
    assert -force_at(history, 0.75, 1) == pytest.approx(BEARING, rel=0.05)
    assert force_at(history, 1.0, 1) == pytest.approx(0.0, abs=1e-8)


def test_blade_is_passive_then_active_and_passive_again(tmp_path):
    history = run(BLADE, tmp_path)
    # but for the second step, in which the tip begins to part the sand, none is halved
    assert np.all(history["is_complete"][history["time"] > 0.0501])
    first, second = force_at(history, 0.25, 0), force_at(history, 0.75, 0)
    # cohesion holds a face of 1 without a blade: 4 c/(gamma sqrt(Ka)) = 0.69, but not all of it
    assert 0.0 <= force_at(history, 0.5, 0) < 0.03 * first
    assert second == pytest.approx(first, rel=0.15)


def test_sand_follows_a_blade_over_an_edge(tmp_path):
    history = run(EDGE, tmp_path)
    assert history["is_complete"].sum() >= 10
    # all of its weight of 100 is borne at rest, some of it by the shelf, where nothing was at first
    forces = history["boundary_reactions"]
    assert forces[-1, :, 1].sum() == pytest.approx(100.0, rel=1e-6)
    assert forces[0, 2, 1] == 0.0
    assert forces[-1, 2, 1] > 0.1
