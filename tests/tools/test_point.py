"""User materials and tests on samples as a user meets them: compile, check, run, draw."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).parents[2]))
PROGRAM = os.environ.get("COULTER_PROGRAM", str(SOURCE / "build/release/coulter"))
sys.path.insert(0, str(SOURCE / "postproc"))

TESTS = """
&law name = 'steel', model = 'umat', library = 'lib/mises.so', n_state = 5
   constants = 300.0, 0.25, 20.0, 5.0 /
&sample name = 'bar', law = 'steel', void_ratio = 0.5 /
&stage sample = 'bar', test = 'triaxial', axial_strain = -0.2, increments = 20 /
"""
SCENE = """
&grid origin = 0.0, 0.0, spacing = 1.0, cells = 4, 4 /
&body name = 'block', law = 'steel', density = 0.0 /
&region body = 'block', rectangle = 0.0, 0.0, 2.0, 2.0 /
&fixity name = 'base', side = 'bottom', held = 'y' /
&fixity name = 'left', side = 'left', held = 'x' /
&boundary name = 'press', kind = 'roller', vertices = 3.0, 2.0, 0.0, 2.0
   displacement = 0.0, -0.4 /
&steps count = 4 /
"""


@pytest.fixture(scope="module")
def deck(tmp_path_factory) -> Path:
    """A deck beside the folder of its library, compiled by the documented command."""
    folder = tmp_path_factory.mktemp("umat")
    (folder / "lib").mkdir()
    shutil.copy(SOURCE / "tests/umat/von_mises.f90", folder / "lib/mises.f90")
    subprocess.run([SOURCE / "scripts/build_umat.sh", folder / "lib/mises.f90"], check=True)
    (folder / "deck.nml").write_text(TESTS + SCENE, encoding="utf-8")
    return folder / "deck.nml"


def run(*arguments, cwd) -> subprocess.CompletedProcess:
    return subprocess.run([PROGRAM, *arguments], cwd=cwd, timeout=60, capture_output=True,
                          text=True, check=False)


def test_library_is_found_from_the_deck(deck, tmp_path):
    # elsewhere is the current folder
    result = run("--check", deck, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "user material of law steel, at one point" in result.stdout
    assert "zero strain leaves the stress as it is" in result.stdout
    assert "WRONG" not in result.stdout


def test_user_material_runs(deck, tmp_path):
    result = run("--output", tmp_path, deck, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "deck.vtkhdf").exists()


def test_table_and_figure(deck, tmp_path):
    np = pytest.importorskip("numpy")
    pytest.importorskip("matplotlib")
    from coulter_post.__main__ import main
    from coulter_post.samples import Sample

    result = run("point", "--output", tmp_path / "new", deck, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "bar: 20 increments" in result.stdout
    table = Sample(tmp_path / "new/deck_bar.csv")
    assert len(table["p"]) == 21
    # uniaxial: q = - sigma_yy, on the yield surface 20 + 5 plastic strain; p = q/3
    assert np.allclose(table["q"], -table["stress_yy"], rtol=0.0, atol=1e-8)
    assert np.isclose(table["q"][-1], 20.0 + 5.0 * table["sdv_1"][-1], rtol=1e-9)
    assert np.allclose(table["p"], table["q"] / 3.0, rtol=0.0, atol=1e-8)
    assert table["void_ratio"][0] == 0.5
    assert not table.is_sheared
    assert main(["point", str(table.path), str(table.path)]) == 0
    assert table.path.with_suffix(".png").stat().st_size > 10000


def test_failure_keeps_what_was_reached(deck, tmp_path):
    text = deck.read_text(encoding="utf-8").replace("20.0, 5.0", "20.0, 0.0")
    text = text.replace("axial_strain = -0.2", "axial_stress = -25.0")
    (deck.parent / "weak.nml").write_text(text, encoding="utf-8")
    result = run("point", "--output", tmp_path, deck.parent / "weak.nml", cwd=tmp_path)
    assert result.returncode == 1
    assert result.stderr.startswith("coulter: sample bar: increment 17 of 20 of stage 1 fails: ")
    assert len((tmp_path / "weak_bar.csv").read_text(encoding="utf-8").splitlines()) == 18


def test_no_figure_of_other_tables(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    from coulter_post.__main__ import main

    (tmp_path / "x.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    assert main(["point", str(tmp_path / "x.csv")]) == 1
    assert "is no table of coulter point" in capsys.readouterr().err
