"""Results files as others see them: VTK's own reader, h5py, during a run and after a kill."""

import math
import os
import random
import re
import shutil
import subprocess
import time
from pathlib import Path

import pytest

h5py = pytest.importorskip("h5py")
np = pytest.importorskip("numpy")

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).parents[2]))
PROGRAM = os.environ.get("COULTER_PROGRAM", str(SOURCE / "build/release/coulter"))
COMPONENTS = {
    "displacement": 3,
    "stress": 6,
    "strain": 6,
    "deformation_gradient": 9,
    "volume_ratio": 1,
    "volume": 1,
    "domain": 3,
    "body": 1,
}
#: A block with a bevelled corner, tiled; the plate on it is pressed down and then lifted off.
TILED = """
&scene title = "Bevelled block" /
&grid origin = -1.0, -1.0, spacing = 1.0, cells = 6, 5 /
&law name = "stuff", model = "hencky", youngs_modulus = 1000.0, poisson_ratio = 0.3 /
&body name = "block", law = "stuff", density = 0.0 /
&region body = "block", polygon = 0.0, 0.0,  4.0, 0.0,  4.0, 1.3,  3.3, 2.0,  0.0, 2.0 /
&boundary name = "floor", kind = "roller", vertices = 0.0, 0.0,  4.0, 0.0, bilateral = .true. /
&boundary name = "left", kind = "roller", vertices = 0.0, 2.0,  0.0, 0.0, bilateral = .true. /
&boundary
   name = "plate", kind = "roller", vertices = 4.0, 2.0,  0.0, 2.0
   displacement = 0.0, 0.1, table = "lift"
/
&table name = "lift", time = 0.0, 1.0, 2.0, value = 0.0, -0.1, 1.0 /
&steps end_times = 1.0, 2.0 /
"""


def make_deck(folder: Path, n_steps: int, output: str = "") -> Path:
    """The patch deck in so many steps."""
    text = (SOURCE / "input/patch/patch.nml").read_text()
    text, n_changes = re.subn(r"&steps count = \d+ /", f"&steps count = {n_steps} /", text)
    assert n_changes == 1
    deck = folder / "patch.nml"
    deck.write_text(text + (f"&output {output} /\n" if output else ""))
    return deck


def run(deck: Path, *options: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [PROGRAM, str(deck), "--quiet", "--output", str(deck.parent), *options],
        capture_output=True,
        text=True,
        timeout=120,
    )


def results_of(deck: Path) -> Path:
    done = run(deck)
    assert done.returncode == 0, done.stderr
    return deck.with_suffix(".vtkhdf")


def read_frame(file: "h5py.File", name: str, frame: int) -> "np.ndarray":
    root = file["VTKHDF"]
    first, n = root["Steps/PointOffsets"][frame], root["NumberOfPoints"][frame]
    return root[name][first : first + n]


def make_tiled_deck(folder: Path, text: str = TILED) -> Path:
    deck = folder / "tiled.nml"
    deck.write_text(text)
    return deck


@pytest.mark.parametrize("output", ["", "compression = 4", "precision = 'single'"])
def test_vtk_reads_all_steps(tmp_path, output):
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    path = results_of(make_deck(tmp_path, 4, output))
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == 5
    with h5py.File(path) as file:
        for frame in range(5):
            reader.SetStep(frame)
            reader.Update()
            data = reader.GetOutputDataObject(0)
            n_points = int(file["VTKHDF/NumberOfPoints"][frame])
            assert data.GetNumberOfPoints() == data.GetNumberOfVerts() == n_points
            assert math.isclose(reader.GetTimeValue(), file["VTKHDF/Steps/Values"][frame])
            arrays = data.GetPointData()
            found = {
                arrays.GetArrayName(i): arrays.GetArray(i).GetNumberOfComponents()
                for i in range(arrays.GetNumberOfArrays())
            }
            assert found == COMPONENTS
            np.testing.assert_array_equal(
                vtk_to_numpy(arrays.GetArray("displacement")),
                read_frame(file, "PointData/displacement", frame),
            )


def test_fields_agree_with_each_other(tmp_path):
    """Positions move with displacements, J is the determinant of F, volumes follow J."""
    with h5py.File(results_of(make_deck(tmp_path, 2))) as file:
        start, end = (
            {name: read_frame(file, f"PointData/{name}", k) for name in COMPONENTS} for k in (0, 2)
        )
        moved = read_frame(file, "Points", 0) + end["displacement"]
        np.testing.assert_allclose(read_frame(file, "Points", 2), moved, atol=1e-12)
        gradient = end["deformation_gradient"].reshape(-1, 3, 3)
        np.testing.assert_allclose(np.linalg.det(gradient), end["volume_ratio"], rtol=1e-10)
        np.testing.assert_allclose(end["volume"], start["volume"] * end["volume_ratio"])
        assert not start["stress"].any()
        assert np.all(start["domain"][:, :2] > 0.0)


def test_tiles_are_the_domains(tmp_path):
    """Counter-clockwise around their points, with the volume of their points; a push moves them."""
    text = TILED.replace("-0.1, 1.0 /", "-0.5, -1.0 /")
    with h5py.File(results_of(make_tiled_deck(tmp_path, text))) as file:
        assert file["VTKHDF/PointData/tile"].attrs["description"]
        for frame in (0, 2):
            tile = read_frame(file, "PointData/tile", frame).reshape(-1, 4, 2)
            x, y = np.moveaxis(tile, -1, 0)
            area = 0.5 * np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)
            volume = read_frame(file, "PointData/volume", frame)
            np.testing.assert_allclose(area, volume, rtol=1e-10)
            assert math.isclose(y.max(), 2.0 - 0.05 * frame, rel_tol=1e-2)
        # 0.7 by 0.7 is cut off the corner
        assert math.isclose(read_frame(file, "PointData/volume", 0).sum(), 8.0 - 0.5 * 0.7**2)
        assert np.any(np.all(tile[:, 2] == tile[:, 3], axis=1))
    with h5py.File(results_of(make_deck(tmp_path, 1))) as file:
        assert "tile" not in file["VTKHDF/PointData"]


def test_vtk_reads_tiles(tmp_path):
    vtk = pytest.importorskip("vtk")

    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(results_of(make_tiled_deck(tmp_path))))
    reader.Update()
    tile = reader.GetOutputDataObject(0).GetPointData().GetArray("tile")
    assert tile.GetNumberOfComponents() == 8


def test_boundaries_say_how_they_act(tmp_path):
    with h5py.File(results_of(make_tiled_deck(tmp_path))) as file:
        assert list(file["boundaries/kind"]) == [b"roller"] * 3
        assert list(file["boundaries/formulation"]) == [b"nitsche"] * 3
        assert list(file["boundaries/is_bilateral"]) == [1, 1, 0]
    with h5py.File(results_of(make_deck(tmp_path, 1))) as file:
        assert list(file["boundaries/formulation"]) == [b"implicit"] * 3
        assert list(file["boundaries/is_bilateral"]) == [1, 1, 1]


def test_loaded_length_is_the_length_in_contact(tmp_path):
    """The plate is pressed on the edge of 3.3 beside the bevel, then it is off."""
    with h5py.File(results_of(make_tiled_deck(tmp_path))) as file:
        lengths = file["history/loaded_lengths"][:]
    np.testing.assert_allclose(lengths[0, :2], [4.0, 2.0])
    # half an edge of the bevel counts with the corner that it shares
    assert 3.3 - 1e-9 <= lengths[0, 2] <= 3.3 + 0.5 * 0.7
    assert lengths[1, 2] == 0.0


def test_warnings_are_kept(tmp_path):
    with h5py.File(results_of(make_tiled_deck(tmp_path))) as file:
        assert list(file["history/warning_rows"]) == [1]
        assert list(file["history/warning_texts"]) == [b"boundary plate holds no material"]
    held = TILED.replace("-0.1, 1.0 /", "-0.1, -1.0 /")
    with h5py.File(results_of(make_tiled_deck(tmp_path, held))) as file:
        assert len(file["history/warning_rows"]) == len(file["history/warning_texts"]) == 0


def test_time_of_a_failed_end_is_kept(tmp_path):
    """The plate is pushed through the floor: the second step fails at any size."""
    text = TILED.replace("-0.1, 1.0 /", "-0.1, -90.0 /") + "&control max_halvings = 1 /\n&output every = 2 /\n"
    deck = make_tiled_deck(tmp_path, text)
    assert run(deck).returncode == 1
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        assert file["provenance"].attrs["status"].startswith(b"failed: step 2 of 2")
        # the last state that was accepted, although no frame was due
        assert list(file["frames/step"]) == [0, 1]
        names = [name.decode() for name in file["history/phase_names"]]
        seconds = dict(zip(names, file["provenance/last_seconds"], strict=True))
    assert seconds["factorise"] > 0.0


def test_strain_and_stress_obey_the_law(tmp_path):
    """Hencky: Kirchhoff stress J sigma = lambda tr(e) 1 + 2 G e, E = 1000, nu = 0.3."""
    with h5py.File(results_of(make_deck(tmp_path, 2))) as file:
        names = ("stress", "strain", "volume_ratio")
        stress, strain, ratio = (read_frame(file, f"PointData/{name}", 2) for name in names)
    shear, lame = 1000.0 / 2.6, 1000.0 * 0.3 / (1.3 * 0.4)
    expected = 2.0 * shear * strain
    expected[:, :3] += lame * strain[:, :3].sum(axis=1, keepdims=True)
    np.testing.assert_allclose(stress * ratio[:, None], expected, atol=1e-9 * abs(expected).max())


def test_stress_belongs_to_the_shared_volume(tmp_path):
    """With F-bar J is that of the cell, whose logarithm is the trace of the elastic strain."""
    text = TILED.replace("density = 0.0", "density = 0.0, points_per_cell = 2")
    text = text.replace("-0.1, 1.0 /", "-0.5, -1.0 /") + "&control volumetric = 'fbar' /\n"
    with h5py.File(results_of(make_tiled_deck(tmp_path, text))) as file:
        names = ("stress", "strain", "volume_ratio")
        stress, strain, ratio = (read_frame(file, f"PointData/{name}", 2) for name in names)
    trace = strain[:, :3].sum(axis=1, keepdims=True)
    assert np.abs(np.exp(trace[:, 0]) - ratio).max() > 1e-3
    expected = 2.0 * 1000.0 / 2.6 * strain
    expected[:, :3] += 1000.0 * 0.3 / (1.3 * 0.4) * trace
    np.testing.assert_allclose(stress * np.exp(trace), expected, atol=1e-9 * abs(expected).max())


def test_stations_carry_the_forces(tmp_path):
    """Frame by frame: a plate with friction, pressed down and then drawn aside."""
    text = TILED[: TILED.index("&boundary\n")] + """
&tool name = "plate", shape = "rectangle", size = 2.0, 0.5, position = 1.5, 2.0, friction = 0.2 /
&motion tool = "plate", phase = "press", displacement = 0.0, -0.1 /
&motion tool = "plate", phase = "draw", displacement = 0.3, 0.0 /
&phase name = "press", count = 2 /
&phase name = "draw", count = 3 /
"""
    with h5py.File(results_of(make_tiled_deck(tmp_path, text))) as file:
        stations = {name: file[f"stations/{name}"][:] for name in file["stations"]}
        forces = file["history/boundary_reactions"][:, 2]
    n_rows = stations["n_rows"]
    np.testing.assert_array_equal(stations["first_row"], np.cumsum(n_rows) - n_rows)
    assert n_rows.sum() == len(stations["length"])
    for frame in range(1, 6):
        rows = slice(stations["first_row"][frame], stations["first_row"][frame] + n_rows[frame])
        mine = stations["boundary"][rows] == 3
        length, slip = stations["length"][rows][mine], stations["slip"][rows][mine]
        normal, shear = stations["traction"][rows][mine].T
        # the plate is level, but for the edges that bend around its corners
        assert np.dot(length, normal) == pytest.approx(forces[frame - 1][1], rel=1e-2)
        assert np.all(shear[slip != 0] * slip[slip != 0] > 0.0)
    assert np.all(slip != 0)


def test_points_have_no_stations(tmp_path):
    """Only corners of tiles do: without them the group is not there at all."""
    with h5py.File(results_of(make_deck(tmp_path, 2))) as file:
        assert "stations" not in file


def test_last_step_is_kept_with_its_stations(tmp_path):
    text = TILED.replace("-0.1, 1.0 /", "-0.1, -0.2 /") + "&output every = 9 /\n"
    with h5py.File(results_of(make_tiled_deck(tmp_path, text))) as file:
        assert list(file["frames/step"]) == [0, 2]
        assert file["stations/n_rows"][1] > 0


def test_file_describes_itself(tmp_path):
    deck = make_deck(tmp_path, 2)
    with h5py.File(results_of(deck)) as file:
        assert file["deck"][0].decode().rstrip() == deck.read_text().rstrip()
        assert file["deck"].attrs["path"].decode() == str(deck)
        assert file["provenance"].attrs["status"] == b"finished"
        assert file["provenance"].attrs["version"]
        assert [name.decode() for name in file["boundaries/name"]] == ["base", "left", "top"]
        for name in COMPONENTS:
            attributes = file[f"VTKHDF/PointData/{name}"].attrs
            assert attributes["description"] and "unit" in attributes
        undescribed = []
        file["history"].visititems(
            lambda name, column: None
            if name.endswith("_names") or column.attrs.get("description")
            else undescribed.append(name)
        )
        assert not undescribed


def test_units_are_those_of_the_deck(tmp_path):
    names = ("VTKHDF/Points", "VTKHDF/PointData/volume", "VTKHDF/PointData/stress")
    for units, expected in {
        ", length_unit = 'm', stress_unit = 'kPa'": [b"m", b"m^2", b"kPa"],
        "": [b"", b"", b""],
    }.items():
        text = TILED.replace('"Bevelled block"', '"Bevelled block"' + units)
        with h5py.File(results_of(make_tiled_deck(tmp_path, text))) as file:
            assert [file[name].attrs["unit"] for name in names] == expected


def test_history_has_a_row_per_step(tmp_path):
    with h5py.File(results_of(make_deck(tmp_path, 3))) as file:
        history = file["history"]
        assert history.attrs["n_rows"] == 3
        assert list(history["step"]) == [1, 2, 3]
        np.testing.assert_allclose(history["load_factor"], [1 / 3, 2 / 3, 1])
        assert history["boundary_reactions"].shape == (3, 3, 2)
        # equilibrium: nothing but the boundaries acts on the body
        forces = history["boundary_reactions"][:]
        np.testing.assert_allclose(forces.sum(axis=1), 0.0, atol=1e-6 * abs(forces).max())
        for row, n in zip(history["residuals"], history["n_iterations"], strict=True):
            assert np.isfinite(row[: n + 1]).all() and np.isnan(row[n + 1 :]).all()


@pytest.mark.parametrize(
    ("output", "steps"),
    [("every = 2", [0, 2, 4, 5]), ("at_steps = 1, 3", [0, 1, 3, 5]), ("every = 9", [0, 5])],
)
def test_chosen_steps_become_frames(tmp_path, output, steps):
    with h5py.File(results_of(make_deck(tmp_path, 5, output))) as file:
        assert list(file["frames/step"]) == steps
        assert file["VTKHDF/Steps"].attrs["NSteps"] == len(steps)
        assert file["boundaries/vertices"].shape[0] == len(steps)


def test_parts_of_halved_steps_are_rows(tmp_path):
    """Three iterations are not enough for the whole way, but for parts of it."""
    text = TILED.replace("-0.1, 1.0 /", "-3.0, -3.0 /") + "&control max_iterations = 3 /\n"
    names = ("step", "is_complete", "n_halvings")
    with h5py.File(results_of(make_tiled_deck(tmp_path, text))) as file:
        history = {name: file[f"history/{name}"][:] for name in names}
        assert list(file["frames/step"]) == [0, 1, 2]
    parts = history["step"] == 1
    assert parts.sum() > 1 and history["n_halvings"][parts].max() > 0
    assert list(history["is_complete"][parts]) == [0] * (parts.sum() - 1) + [1]


def test_boundaries_move_with_their_displacement(tmp_path):
    with h5py.File(results_of(make_deck(tmp_path, 2))) as file:
        first = file["boundaries/offsets"][2]
        corners = file["boundaries/vertices"][:, first:, :]
        moves = file["history/boundary_displacements"][:, 2]
    for frame in (1, 2):
        expected = corners[0] + moves[frame - 1]
        np.testing.assert_allclose(corners[frame], expected, atol=1e-12)


def test_a_bad_deck_leaves_older_results_alone(tmp_path):
    deck = make_deck(tmp_path, 1)
    before = results_of(deck).read_bytes()
    deck.write_text(deck.read_text().replace("poisson_ratio = 0.3", "poisson_ratio = 0.7"))
    assert run(deck).returncode != 0
    assert deck.with_suffix(".vtkhdf").read_bytes() == before


def test_a_directory_that_cannot_be_made_is_named(tmp_path):
    deck = make_deck(tmp_path, 1)
    done = run(deck, "--output", str(deck / "below"))
    assert done.returncode != 0
    assert str(deck) in done.stderr


def start_long_run(folder: Path, output: str) -> tuple[subprocess.Popen, Path]:
    deck = make_deck(folder, 5000, output)
    command = [PROGRAM, str(deck), "--quiet", "--output", str(folder)]
    path = deck.with_suffix(".vtkhdf")
    path.unlink(missing_ok=True)
    process = subprocess.Popen(command)
    while not path.exists():
        assert process.poll() is None
        time.sleep(0.01)
    return process, path


def check_all_rows(path: Path) -> int:
    """Everything that counts is there and makes sense; returns the number of frames."""
    with h5py.File(path, "r", locking=False) as file:
        n_frames = int(file["VTKHDF/Steps"].attrs["NSteps"])
        n_rows = int(file["history"].attrs["n_rows"])
        assert np.isfinite(file["history/residuals"][:n_rows, 0]).all()
        assert n_frames <= n_rows + 1
        for frame in range(n_frames):
            ratio = read_frame(file, "PointData/volume_ratio", frame)
            assert len(ratio) > 0 and np.all(ratio > 0.5)
    return n_frames


@pytest.mark.parametrize("output", ["compression = 0", "compression = 4"])
def test_a_killed_run_leaves_a_readable_file(tmp_path, output):
    rng = random.Random(1)
    for attempt in range(8):
        folder = tmp_path / str(attempt)
        folder.mkdir()
        process, path = start_long_run(folder, output)
        time.sleep(rng.uniform(0.15, 0.4))
        process.kill()
        process.wait()
        check_all_rows(path)
        shutil.rmtree(folder)


def test_a_running_job_can_be_read(tmp_path):
    """A reader that keeps the file open does not end the run either."""
    process, path = start_long_run(tmp_path, "every = 20")
    try:
        seen = 0
        while seen < 3 and process.poll() is None:
            time.sleep(0.01)
            try:
                with h5py.File(path, "r") as file:
                    seen = max(seen, int(file["VTKHDF/Steps"].attrs["NSteps"]))
                    time.sleep(0.02)
            except (OSError, KeyError):
                continue
        assert seen >= 3
        assert process.poll() is None
    finally:
        process.kill()
        process.wait()
