"""A hypoplastic user material (tests/umat/hypoplastic.f90) against its rate equations.

The equations of von Wolffersdorff (1996) are written here a second time, with full tensors, and
integrated by the classical Runge-Kutta method in many small steps. Constants: Hochstetten sand, from
that paper.
"""
import os
import subprocess
from pathlib import Path

import pytest

np = pytest.importorskip("numpy")

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).parents[2]))
PROGRAM = os.environ.get("COULTER_PROGRAM", str(SOURCE / "build/release/coulter"))
ANGLE, HARDNESS, EXPONENT, DENSEST, CRITICAL, LOOSEST, ALPHA, BETA, SHIFT = (
    33.0, 1.0e6, 0.25, 0.55, 0.95, 1.05, 0.25, 1.5, 0.1)
LAW = """
&law name = 'sand', model = 'umat', library = 'hypoplastic.so', n_state = 2, initial_state = 0.7
   constants = 33.0, 1.0e6, 0.25, 0.55, 0.95, 1.05, 0.25, 1.5, 0.1
   youngs_modulus = 2.0e4, poisson_ratio = 0.25 WATER/
"""
WORST = 1e-5  # the UMAT holds 1e-7 of the stress in every substep


def stress_rate(stress, void_ratio, stretching):
    """dT/dt of a Cauchy stress, 3 x 3, tension positive."""
    one = np.eye(3)
    skeleton = stress - SHIFT * one
    pressure = -np.trace(skeleton)
    ratio = skeleton / np.trace(skeleton)
    deviator = ratio - one / 3.0
    sine = np.sin(np.radians(ANGLE))
    a = np.sqrt(3.0) * (3.0 - sine) / (2.0 * np.sqrt(2.0) * sine)
    tangent = np.sqrt(3.0) * np.linalg.norm(deviator)
    cube = np.trace(deviator @ deviator @ deviator)
    cosine = 1.0
    if tangent > 1e-9:
        cosine = -np.sqrt(6.0) * cube / np.trace(deviator @ deviator) ** 1.5
    f = np.sqrt(tangent**2 / 8 + (2 - tangent**2) / (2 + np.sqrt(2) * tangent * cosine))
    f -= tangent / (2 * np.sqrt(2))
    compression = np.exp(-((pressure / HARDNESS) ** EXPONENT))
    densest, critical, loosest = (e * compression for e in (DENSEST, CRITICAL, LOOSEST))
    f_d = ((void_ratio - densest) / (critical - densest)) ** ALPHA
    f_e = (critical / void_ratio) ** BETA
    f_b = (HARDNESS / EXPONENT * (LOOSEST / CRITICAL) ** BETA * (1 + loosest) / loosest
           * (pressure / HARDNESS) ** (1 - EXPONENT)
           / (3 + a**2 - np.sqrt(3) * a * ((LOOSEST - DENSEST) / (CRITICAL - DENSEST)) ** ALPHA))
    linear = f**2 * stretching + a**2 * ratio * np.sum(ratio * stretching)
    other = f_d * a * f * (ratio + deviator) * np.linalg.norm(stretching)
    return f_b * f_e / np.sum(ratio**2) * (linear + other)


def integrate(stress, void_ratio, stretching_of, count):
    """Runge-Kutta from time 0 to 1; the stretching may depend on the state."""
    def rate(state):
        stress, void_ratio = state[:9].reshape(3, 3), state[9]
        stretching = stretching_of(stress, void_ratio)
        return np.append(stress_rate(stress, void_ratio, stretching),
                         (1 + void_ratio) * np.trace(stretching))

    state = np.append(stress, void_ratio)
    for _ in range(count):
        k1 = rate(state)
        k2 = rate(state + 0.5 / count * k1)
        k3 = rate(state + 0.5 / count * k2)
        k4 = rate(state + 1.0 / count * k3)
        state = state + (k1 + 2 * k2 + 2 * k3 + k4) / (6 * count)
    return state[:9].reshape(3, 3), state[9]


def round_stretching(axial):
    """Stretching of a triaxial test at constant lateral stress: secants for the lateral rate."""
    def rate(lateral, stress, void_ratio):
        return stress_rate(stress, void_ratio, np.diag([lateral, axial, lateral]))[0, 0]

    def find(stress, void_ratio):
        old, new = 0.0, -0.5 * axial
        f_old, f_new = (rate(x, stress, void_ratio) for x in (old, new))
        for _ in range(20):
            if abs(f_new) < 1e-7 * np.abs(stress).max() or f_new == f_old:
                break
            old, new = new, new - f_new * (new - old) / (f_new - f_old)
            f_old, f_new = f_new, rate(new, stress, void_ratio)
        return np.diag([new, axial, new])
    return find


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("sand")
    subprocess.run([SOURCE / "scripts/build_umat.sh", SOURCE / "tests/umat/hypoplastic.f90",
                    folder / "hypoplastic.so", f"-J{folder}"], check=True)
    return folder


def run(folder, name, deck, *command):
    (folder / f"{name}.nml").write_text(deck, encoding="utf-8")
    result = subprocess.run([PROGRAM, *command, f"{name}.nml"], cwd=folder, timeout=120,
                            capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return result


def last_rows(path):
    """Last row of every stage of a table."""
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [dict(zip(lines[0].split(","), map(float, line.split(",")))) for line in lines[1:]]
    return [[row for row in rows if row["stage"] == k][-1] for k in (1.0, rows[-1]["stage"])]


@pytest.mark.parametrize("components", [4, 6])
def test_oedometer(folder, components):
    """Loaded by 2 % strain, unloaded by 0.4 %."""
    law = LAW.replace("WATER", f"umat_components = {components} ")
    run(folder, "oedometer", law + """
&sample name = 's', law = 'sand', initial_stress = -10.0, -20.0, -10.0, 0.0, void_ratio = 0.7 /
&stage sample = 's', test = 'oedometer', axial_strain = -0.02, increments = 10 /
&stage sample = 's', test = 'oedometer', axial_strain = 0.004, increments = 10 /
""", "point")
    stress, void_ratio = np.diag([-10.0, -20.0, -10.0]), 0.7
    for row, strain in zip(last_rows(folder / "oedometer_s.csv"), (-0.02, 0.004)):
        stress, void_ratio = integrate(stress, void_ratio,
                                       lambda s, e, d=strain: np.diag([0.0, d, 0.0]), 400)
        size = np.abs(stress).max()
        assert row["stress_yy"] == pytest.approx(stress[1, 1], abs=WORST * size)
        assert row["stress_xx"] == pytest.approx(stress[0, 0], abs=WORST * size)
        assert row["sdv_1"] == pytest.approx(void_ratio, rel=1e-7)
        if strain < 0.0:
            largest = size
    # stiff in unloading: a fifth of the strain takes off most of the stress
    assert row["stress_yy"] > -0.3 * largest


def test_triaxial(folder):
    """10 % of compression at 100 kPa: beyond the peak, in small increments, since the ratio of the
    strains is constant in each. Newton's method takes few iterations with DDSDDE."""
    run(folder, "triaxial", LAW.replace("WATER", "") + """
&sample name = 's', law = 'sand', initial_stress = 3*-100.0, 0.0, void_ratio = 0.7 /
&stage sample = 's', test = 'triaxial', axial_strain = -0.1, increments = 200 /
""", "point")
    row = last_rows(folder / "triaxial_s.csv")[1]
    stress, void_ratio = integrate(np.diag([-100.0] * 3), 0.7, round_stretching(-0.1), 400)
    assert stress[0, 0] == pytest.approx(-100.0, rel=1e-6)
    assert row["stress_yy"] == pytest.approx(stress[1, 1], rel=WORST)
    assert row["void_ratio"] == pytest.approx(void_ratio, rel=WORST)
    lines = (folder / "triaxial_s.csv").read_text(encoding="utf-8").splitlines()
    at = lines[0].split(",").index("iterations")
    assert max(float(line.split(",")[at]) for line in lines[1:]) <= 7


def test_undrained_triaxial(folder):
    """Water beside the user material, nearly incompressible: effective stress as without volume
    strain, and the total lateral stress is kept."""
    water = 4.0e6
    law = LAW.replace("WATER", f"water_bulk_modulus = {water} ")
    run(folder, "undrained", law + """
&sample name = 's', law = 'sand', initial_stress = 3*-100.0, 0.0, void_ratio = 0.7 /
&stage sample = 's', test = 'triaxial', axial_strain = -0.03, increments = 30 /
""", "point")
    row = last_rows(folder / "undrained_s.csv")[1]
    stress, _ = integrate(np.diag([-100.0] * 3), 0.7,
                          lambda s, e: np.diag([0.015, -0.03, 0.015]), 400)
    pressure = row["excess_pore_pressure"]
    assert row["stress_xx"] == pytest.approx(-100.0, rel=1e-6)
    assert pressure == pytest.approx(-water * row["volume_strain"], rel=1e-8)
    # the skeleton follows what the water gives way, with some ten times the pressure as stiffness
    assert row["stress_xx"] + pressure == pytest.approx(stress[0, 0], rel=5e-3)
    assert row["stress_yy"] + pressure == pytest.approx(stress[1, 1], rel=5e-3)


def test_smaller_steps_are_asked_for(folder):
    """Stretched until nothing holds the grains together: PNEWDT, and a message in the end."""
    (folder / "loose.nml").write_text(LAW.replace("WATER", "") + """
&sample name = 's', law = 'sand', initial_stress = 3*-100.0, 0.0, void_ratio = 0.7 /
&stage sample = 's', test = 'oedometer', axial_strain = 0.1, increments = 20 /
""", encoding="utf-8")
    result = subprocess.run([PROGRAM, "point", "loose.nml"], cwd=folder, timeout=60,
                            capture_output=True, text=True, check=False)
    assert result.returncode == 1
    assert "the user material asks for 0.5 of the step (PNEWDT)" in result.stderr


SCENE = """
&grid origin = 0.0, 0.0, spacing = 0.25, cells = 18, 10 /
&body name = 'soil', law = 'sand', density = 1.8, k0 = 0.45, overburden = 20.0 /
&region body = 'soil', rectangle = 0.0, 0.0, 4.0, 2.0 /
&fixity name = 'base', side = 'bottom', held = 'xy' /
&fixity name = 'left', side = 'left', held = 'x' /
&fixity name = 'right', lower = 4.0, 0.0, upper = 4.0, 2.5, held = 'x' /
&edge_load name = 'cover', vertices = 4.0, 2.0, 1.0, 2.0, pressure = 20.0, from_start = .true. /
&boundary name = 'footing', kind = 'roller', vertices = 1.0, 2.0, -1.0, 2.0
   displacement = 0.0, -0.02 /
&body_force acceleration = 0.0, -10.0, from_start = .true. /
&steps count = 10 /
"""


def test_footing(folder):
    """A footing settles on the sand: every step converges, quadratically in the end, unhalved."""
    h5py = pytest.importorskip("h5py")
    result = run(folder, "check", LAW.replace("WATER", "") + SCENE, "--check")
    assert "WRONG" not in result.stdout
    run(folder, "footing", LAW.replace("WATER", "") + SCENE)
    with h5py.File(folder / "footing.vtkhdf") as file:
        history = file["history"]
        iterations = history["n_iterations"][:]
        force = -history["boundary_reactions"][:, 0, 1]
        residuals = history["residuals"][:]
    assert len(iterations) == 10
    assert iterations.max() <= 8
    # 100 kPa of mean pressure are reached, and the force grows all the way
    assert np.all(np.diff(force) > 0.0)
    for count, row in zip(iterations, residuals):
        last = row[:count + 1]
        assert last[-1] < max(100.0 * last[-2] ** 2, 1e-8)
