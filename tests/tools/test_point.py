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


LAWS = """
&law name = 'mises_built_in', model = 'von_mises', youngs_modulus = 3.0e4, poisson_ratio = 0.25
   yield_stress = 20.0 /
&law name = 'mises_umat', model = 'umat', library = 'mises.so', n_state = 5
   constants = 3.0e4, 0.25, 20.0, 0.0 /
&law name = 'mohr_built_in', model = 'mohr_coulomb', youngs_modulus = 3.0e4
   poisson_ratio = 0.25, cohesion = 5.0, friction_angle = 30.0, dilation_angle = 10.0 /
&law name = 'mohr_umat', model = 'umat', library = 'mohr.so', n_state = 1
   constants = 3.0e4, 0.25, 5.0, 30.0, 10.0 /
"""
MODELS = ("mises", "mohr")
KINDS = ("built_in", "umat")


@pytest.fixture(scope="module")
def twins(tmp_path_factory) -> Path:
    """A folder with user materials of laws that are built in as well."""
    folder = tmp_path_factory.mktemp("twins")
    for source, library in (("von_mises", "mises"), ("mohr_coulomb", "mohr")):
        subprocess.run([SOURCE / "scripts/build_umat.sh", SOURCE / f"tests/umat/{source}.f90",
                        folder / f"{library}.so", f"-J{folder}"], check=True)
    return folder


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


def test_samples_agree_with_built_in_laws(twins):
    """Cauchy stress added up against Kirchhoff stress of the elastic strain: the volume strain of
    1 % is how far they may differ; both are on their yield surface."""
    np = pytest.importorskip("numpy")
    pytest.importorskip("matplotlib")
    from coulter_post.samples import Sample

    groups = [LAWS]
    for model in MODELS:
        for kind in KINDS:
            name = f"{model}_{kind}"
            groups.append(
                f"&sample name = '{name}', law = '{name}', initial_stress = 3*-10.0, 0.0 /\n"
                f"&stage sample = '{name}', test = 'triaxial', axial_strain = -0.01,"
                " increments = 20 /\n"
                f"&stage sample = '{name}', test = 'biaxial', axial_strain = 0.01,"
                " increments = 20 /\n"
                f"&stage sample = '{name}', test = 'shear', shear_strain = 0.02,"
                " increments = 20 /\n")
    (twins / "tests.nml").write_text("".join(groups), encoding="utf-8")
    result = run("point", twins / "tests.nml", cwd=twins)
    assert result.returncode == 0, result.stderr
    for model in MODELS:
        built_in, umat = (Sample(twins / f"tests_{model}_{kind}.csv") for kind in KINDS)
        for column in ("stress_xx", "stress_yy", "stress_zz", "stress_xy", "q"):
            scale = np.abs(built_in["q"]).max()
            assert np.abs(built_in[column] - umat[column]).max() < 0.01 * scale, (model, column)
        assert np.abs(built_in["iterations"] - umat["iterations"]).max() <= 2
        assert umat["iterations"].sum() <= 1.1 * built_in["iterations"].sum() + 2


def test_runs_agree_with_built_in_laws(twins):
    """A footing pressed into soil: forces and iterations."""
    h5py = pytest.importorskip("h5py")
    np = pytest.importorskip("numpy")
    scene = """
&grid origin = 0.0, 0.0, spacing = 0.25, cells = 18, 10 /
&region body = 'soil', rectangle = 0.0, 0.0, 4.0, 2.0 /
&fixity name = 'base', side = 'bottom', held = 'xy' /
&fixity name = 'left', side = 'left', held = 'x' /
&fixity name = 'right', lower = 4.0, 0.0, upper = 4.0, 2.5, held = 'x' /
&boundary name = 'footing', kind = 'roller', vertices = 1.0, 2.0, -1.0, 2.0
   displacement = 0.0, -0.005 /
&steps count = 8 /
"""
    force, iterations = {}, {}
    for model in MODELS:
        for kind in KINDS:
            name = f"{model}_{kind}"
            body = f"&body name = 'soil', law = '{name}', density = 0.0 /"
            (twins / f"{name}.nml").write_text(LAWS + body + scene, encoding="utf-8")
            result = run("--quiet", twins / f"{name}.nml", cwd=twins)
            assert result.returncode == 0, result.stderr
            with h5py.File(twins / f"{name}.vtkhdf") as file:
                force[kind] = file["history/boundary_reactions"][:, 0, 1]
                iterations[kind] = int(np.sum(file["history/n_iterations"]))
        difference = np.abs(force["built_in"] - force["umat"]).max()
        assert difference < 0.02 * np.abs(force["built_in"]).max(), (model, force)
        assert iterations["umat"] <= 1.2 * iterations["built_in"], iterations


def test_passive_pressure_of_a_user_material(twins):
    """input/rankine/passive.nml with Mohr-Coulomb as a user material: 3773 kN/m by Rankine."""
    h5py = pytest.importorskip("h5py")
    text = (SOURCE / "input/rankine/passive.nml").read_text(encoding="utf-8")
    start = text.index("&law")
    law = ("&law name = 'silt', model = 'umat', library = 'mohr.so', n_state = 1\n"
           "   constants = 2.0e5, 0.3, 5.0, 30.0, 0.0 ")
    deck = twins / "passive.nml"
    deck.write_text(text[:start] + law + text[text.index("/\n", start):], encoding="utf-8")
    result = run("--quiet", deck, cwd=twins)
    assert result.returncode == 0, result.stderr
    with h5py.File(twins / "passive.vtkhdf") as file:
        force = file["history/boundary_reactions"][:, 2, 0]  # of the wall, the last boundary
    assert abs(force[-1] / 3773.2 - 1.0) < 0.01
    # at rest: K0 = 0.5 of the deck, 0.5 (1000 + 200)
    assert abs(force[1] / 600.0 - 1.0) < 1e-6
