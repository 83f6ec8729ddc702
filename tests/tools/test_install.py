"""The installed library as others meet it: a program of their own (tests/host) that finds it by CMake
or by pkg-config, in a place to which the installation was moved, with a user material; a law of its
own."""
import math
import os
import shutil
import subprocess
from pathlib import Path

import pytest

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).parents[2]))
PROGRAM = Path(os.environ.get("COULTER_PROGRAM", SOURCE / "build/release/coulter"))
DECK = """
&grid origin = 0.0, 0.0, spacing = 1.0, cells = 4, 4 /
&law name = 'steel', model = 'umat', library = 'mises.so', n_state = 5
   constants = 300.0, 0.25, 20.0, 5.0 /
&body name = 'block', law = 'steel', density = 0.0 /
&region body = 'block', rectangle = 0.0, 0.0, 2.0, 2.0 /
&fixity name = 'base', side = 'bottom', held = 'y' /
&fixity name = 'left', side = 'left', held = 'x' /
&boundary name = 'press', kind = 'roller', vertices = 3.0, 2.0, 0.0, 2.0
   displacement = 0.0, -0.4 /
&steps count = 4 /
"""


def run(*command, **options) -> str:
    result = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def prefix(tmp_path_factory) -> Path:
    """An installation that was moved."""
    folder = tmp_path_factory.mktemp("install")
    run("cmake", "--install", PROGRAM.parent, "--prefix", folder / "first")
    shutil.move(folder / "first", folder / "moved")
    return folder / "moved"


@pytest.fixture(scope="module")
def deck(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("deck")
    run(SOURCE / "scripts/build_umat.sh", SOURCE / "tests/umat/von_mises.f90", folder / "mises.so")
    (folder / "deck.nml").write_text(DECK, encoding="utf-8")
    return folder / "deck.nml"


def check_forces(printed, deck):
    """As those of the program."""
    h5py = pytest.importorskip("h5py")
    run(PROGRAM, "--quiet", "deck.nml", cwd=deck.parent)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        expected = file["history/boundary_reactions"][:, 0, 1]
    lines = printed.splitlines()
    assert lines[0] == "4 points"
    assert [float(line.split()[2]) for line in lines[1:]] == pytest.approx(list(expected), rel=1e-7)


def test_cmake_finds_the_library(prefix, deck, tmp_path):
    run("cmake", "-S", SOURCE / "tests/host", "-B", tmp_path, f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", tmp_path)
    check_forces(run(tmp_path / "host", deck, cwd=tmp_path), deck)
    check_column(run(tmp_path / "own_law"))


def check_column(printed):
    """Tiles between smooth walls, 1 wide, 0.9 high: nothing but a vertical strain, ln of the stretch,
    and the lid bears tau_yy / J. K = 100, G = 60, b = 8."""
    forces = [float(line.split()[2]) for line in printed.splitlines()[1:]]
    expected = []
    for stretch in (0.75 / 0.9, 0.6 / 0.9):
        strain = math.log(stretch)
        stress = 100.0 * (1.0 + 8.0 * strain**2) * strain + 2.0 * 60.0 * 2.0 / 3.0 * strain
        expected.append(stress / stretch)
    assert forces == pytest.approx(expected, rel=1e-7)


def test_pkg_config_finds_the_library(prefix, deck, tmp_path):
    if shutil.which("pkg-config") is None:
        pytest.skip("no pkg-config")
    found = next(prefix.rglob("coulter.pc")).parent
    path = os.pathsep.join([str(found), os.environ.get("PKG_CONFIG_PATH", "")])
    flags = run("pkg-config", "--static", "--cflags", "--libs", "coulter",
                env={**os.environ, "PKG_CONFIG_PATH": path}).split()
    # -rdynamic: user materials call utilities of the program
    run(os.environ.get("FC", "gfortran"), "-rdynamic", SOURCE / "tests/host/observer.f90",
        SOURCE / "tests/host/host.f90", *flags,
        "-o", "host", cwd=tmp_path)
    check_forces(run(tmp_path / "host", deck, cwd=tmp_path), deck)


def test_installed_program_runs(prefix, deck):
    run(prefix / "bin/coulter", "--check", deck)
    assert next(prefix.rglob("ABA_PARAM.INC")).parent.name == "umat"
