"""The Python package reads and draws what the program writes."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

np = pytest.importorskip("numpy")
pytest.importorskip("h5py")
pytest.importorskip("matplotlib")

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).parents[2]))
PROGRAM = os.environ.get("COULTER_PROGRAM", str(SOURCE / "build/release/coulter"))
sys.path.insert(0, str(SOURCE / "postproc"))

from coulter_post import Results  # noqa: E402
from coulter_post import figures  # noqa: E402
from coulter_post.__main__ import main  # noqa: E402
from coulter_post.fields import FIELDS  # noqa: E402
from coulter_post.results import Boundary  # noqa: E402

N_STEPS = 4


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("patch")
    text = (SOURCE / "input/patch/patch.nml").read_text()
    deck = folder / "patch.nml"
    deck.write_text(re.sub(r"&steps count = \d+ /", f"&steps count = {N_STEPS} /", text))
    subprocess.run([PROGRAM, deck, "--quiet", "--output", folder], check=True, timeout=120)
    return deck.with_suffix(".vtkhdf")


@pytest.fixture(scope="module")
def results(path) -> Results:
    return Results(path)


@pytest.fixture(scope="module")
def tiled(tmp_path_factory) -> Results:
    """The wedge on a coarse grid, its tool withdrawn in the end."""
    folder = tmp_path_factory.mktemp("tiled")
    text = (SOURCE / "input/wedge/wedge_default.nml").read_text()
    for old, new in (
        ("spacing = 2.0, cells = 136, 34", "spacing = 8.0, cells = 34, 9"),
        ("displacement_per_step = -6.0, 0.0", "displacement = -6.0, 0.0, table = 'back'"),
        (
            "&steps count = 6 /",
            "&table name = 'back', time = 0.0, 1.0, 2.0, value = 0.0, 1.0, -1.0 /\n"
            "&steps end_times = 1.0, 2.0 /",
        ),
        ("at_steps = 1, 3, 5, 6", "every = 1"),
    ):
        assert text.count(old) == 1
        text = text.replace(old, new)
    deck = folder / "tiled.nml"
    deck.write_text(text)
    subprocess.run([PROGRAM, deck, "--quiet", "--output", folder], check=True, timeout=120)
    return Results(deck.with_suffix(".vtkhdf"))


def area_of(polygons):
    x, y = np.moveaxis(polygons, -1, 0)
    return 0.5 * np.sum(x * np.roll(y, -1, axis=-1) - y * np.roll(x, -1, axis=-1), axis=-1)


def test_tiles_are_drawn_as_they_are(tiled):
    frame = tiled.frame(1)
    assert frame.has_tiles
    np.testing.assert_allclose(area_of(frame.outlines()), frame["volume"], rtol=1e-10)
    figure = figures.draw_frames(tiled, [1], "p")
    drawn = [c for c in figure.axes[0].collections if c.get_array() is not None]
    corners = drawn[0].get_paths()[0].vertices[:4]
    np.testing.assert_allclose(corners, frame.outlines()[0])


def test_outer_edges_enclose_the_body(tiled, results):
    """Their fluxes of (x, y)/2 add up to the volume of all tiles; boxes have none."""
    frame = tiled.frame(1)
    start, end = np.moveaxis(frame.outer_edges(), 1, 0)
    enclosed = 0.5 * np.sum(start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0])
    np.testing.assert_allclose(enclosed, frame["volume"].sum(), rtol=1e-10)
    assert len(start) < len(frame.position)
    assert not results.frame(0).has_tiles
    assert results.frame(0).outer_edges().shape == (0, 2, 2)


def test_summary_tells_warnings_below_their_step(tiled, capsys):
    assert (1, "boundary push holds no material") in tiled.warnings
    assert all(row == 1 for row, _ in tiled.warnings)
    assert main(["summary", str(tiled.path)]) == 0
    last_step, *warnings = capsys.readouterr().out.splitlines()[-1 - len(tiled.warnings) :]
    assert last_step.startswith("   2 ")
    assert all(line.startswith("      warning: boundary ") for line in warnings)


def test_few_outliers_do_not_set_the_colours():
    smooth = np.linspace(0.0, 1.0, 1000)
    norm, extend = figures._colour_limits([smooth])
    assert (norm.vmin, norm.vmax, extend) == (0.0, 1.0, "neither")
    norm, extend = figures._colour_limits([smooth, np.append(smooth, 50.0)])
    assert norm.vmin == 0.0 and norm.vmax < 1.01 and extend == "max"
    norm, extend = figures._colour_limits([np.append(smooth, -50.0)])
    assert norm.vmin > -0.01 and norm.vmax == 1.0 and extend == "min"
    constant, extend = figures._colour_limits([np.zeros(5)])
    assert (constant.vmin, constant.vmax, extend) == (0.0, 0.0, "neither")


@pytest.mark.parametrize(("thickness", "stands_above"), [(0.1, True), (2.0, False)])
def test_names_of_slender_tools_stand_above_them(thickness, stands_above):
    right, top = 1.0 + thickness, 3.0
    corners = [[1.0, 0.0], [1.0, top], [right, top], [right, 0.0], [1.0, 0.0]]
    panel = figures.Figure().subplots()
    view = np.array([[0.0, -4.0], [8.0, 4.0]])
    figures._draw_boundary(panel, Boundary("blade", "roller", np.array(corners), True), view)
    (name,) = panel.texts
    assert (name.xy[1] == top and name.xyann[1] > 0.0) == stands_above


def test_frames_by_index_and_by_step(results):
    assert results.n_frames == N_STEPS + 1
    assert results.frame(-1).step == N_STEPS
    assert results.frame_of_step(2).step == 2
    with pytest.raises(KeyError, match="no frame of step 9"):
        results.frame_of_step(9)
    with pytest.raises(IndexError):
        results.frame(N_STEPS + 1)


def test_outlines_cover_the_deformed_volume(results):
    """The area of every outline is the volume of its point, also where the domain was cut."""
    frame = results.frame(-1)
    area = area_of(frame.outlines())
    stretch = frame.gradient[:, 2, 2]
    np.testing.assert_allclose(area * stretch, frame["volume"], rtol=1e-6)


def test_boundaries_know_where_they_are(results):
    names = [boundary.name for boundary in results.frame(0).boundaries]
    assert names == results.boundary_names == ["base", "left", "top"]
    first, last = (results.frame(k).boundaries[2].vertices for k in (0, -1))
    np.testing.assert_allclose(
        last - first, [results.history["boundary_displacements"][-1, 2]] * 2, atol=1e-12
    )


def test_scene_and_origin(results):
    assert results.title
    assert results.provenance["status"] == "finished"
    assert "&boundary" in results.deck
    assert len(results.grid.lines(0)) == results.grid.cells[0] + 1
    assert results.unit("deformation_gradient") == "1"


@pytest.mark.parametrize("field", sorted(FIELDS))
def test_every_field_has_a_value_per_point(results, field):
    frame = results.frame(-1)
    if field in ("plastic", "pore"):
        with pytest.raises(ValueError, match="no law of this run has"):
            FIELDS[field].of(frame)
        frame.data[FIELDS[field].source] = frame["volume"]
    values = FIELDS[field].of(frame)
    assert values.shape == (len(frame.position),)
    assert np.isfinite(values).all()


def test_colours_share_their_limits(results):
    figure = figures.draw_frames(results, [0, 2, 4], "ux")
    limits = {
        artist.get_clim()
        for panel in figure.axes
        for artist in panel.collections
        if artist.get_array() is not None and panel.get_title(loc="left")
    }
    values = np.concatenate([FIELDS["ux"].of(results.frame_of_step(k)) for k in (0, 2, 4)])
    assert limits == {(values.min(), values.max())}


def test_push_force_is_positive_in_compression(results):
    """The top of the patch is pressed down: work is done on the body."""
    (panel,) = figures.draw_forces(results).axes
    curve = panel.lines[0]
    assert curve.get_label() == "top"
    assert curve.get_xdata()[0] == curve.get_ydata()[0] == 0.0
    assert np.all(np.diff(curve.get_xdata()) > 0.0)
    assert np.all(np.diff(curve.get_ydata()) > 0.0)


def test_command_line_draws_and_prints(path, tmp_path, capsys):
    assert main(["figures", str(path), "--steps", "0", "4", "--output", str(tmp_path)]) == 0
    drawn = sorted(file.name for file in tmp_path.iterdir())
    assert drawn == ["patch_convergence.png", "patch_forces.png", "patch_frames_ux.png"]
    assert main(["summary", str(path)]) == 0
    printed = capsys.readouterr().out
    assert "top" in printed and "100 %" in printed


@pytest.fixture(scope="module")
def pipe(tmp_path_factory) -> Results:
    """A pipe that is pressed into a coarse bed and turned."""
    folder = tmp_path_factory.mktemp("pipe")
    text = (SOURCE / "input/pipe/pipe.nml").read_text()
    for old, new in (
        ("spacing = 0.25, cells = 56, 32", "spacing = 0.5, cells = 28, 16"),
        ("&steps count = 20 /", "&steps count = 5 /"),
    ):
        assert text.count(old) == 1
        text = text.replace(old, new)
    deck = folder / "pipe.nml"
    deck.write_text(text)
    subprocess.run([PROGRAM, deck, "--quiet", "--output", folder], check=True, timeout=120)
    return Results(deck.with_suffix(".vtkhdf"))


def test_stations_carry_the_force_of_the_tool(pipe):
    index = pipe.boundary_names.index("pipe")
    frame, history = pipe.frame(-1), pipe.history
    tool, stations = frame.boundaries[index], frame.stations
    assert tool.is_tool
    centre = history["pivots"][-1, index]
    assert np.allclose(np.linalg.norm(tool.polyline() - centre, axis=1), 1.0)
    mine = stations.boundary == index + 1
    assert mine.sum() == history["n_acting"][-1, index]
    normal = stations.position[mine] - centre
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    tangent = np.stack([normal[:, 1], -normal[:, 0]], axis=1)
    traction, length = stations.traction[mine], stations.length[mine]
    forces = -length[:, None] * (traction[:, :1] * normal + traction[:, 1:] * tangent)
    assert np.allclose(forces.sum(axis=0), history["boundary_reactions"][-1, index])
    arm = stations.position[mine] - centre
    moment = np.sum(arm[:, 0] * forces[:, 1] - arm[:, 1] * forces[:, 0])
    assert moment == pytest.approx(history["moments"][-1, index])
    slips = stations.slip[mine] != 0
    assert slips.sum() == history["n_slipping"][-1, index]
    ratio = np.abs(traction[slips, 1] / traction[slips, 0])
    assert np.allclose(ratio, 0.3, rtol=1e-10)
    # forces balance, and the work is that of the force on the way down
    assert np.abs(history["imbalance"]).max() < 1e-6 * np.abs(forces).max()
    assert history["works"][-1, index] > 0.0


def test_table_of_tools_repeats_the_history(pipe):
    lines = pipe.path.with_name("pipe_tools.csv").read_text().splitlines()
    table = np.genfromtxt(lines, delimiter=",", names=None, skip_header=1)
    names = lines[0].split(",")
    index = pipe.boundary_names.index("pipe")
    history = pipe.history
    for name, column in (
        ("pipe:force_y", history["boundary_reactions"][:, index, 1]),
        ("pipe:moment", history["moments"][:, index]),
        ("pipe:rotation", history["rotations"][:, index]),
        ("pipe:contact_length", history["loaded_lengths"][:, index]),
        ("pipe:n_slipping", history["n_slipping"][:, index]),
    ):
        assert np.allclose(table[:, names.index(name)], column, rtol=1e-14), name
    assert np.degrees(history["rotations"][-1, index]) == pytest.approx(60.0)


def test_tools_are_drawn_and_move(pipe, tmp_path, capsys):
    assert main(["figures", str(pipe.path), "--output", str(tmp_path)]) == 0
    assert (tmp_path / "pipe_tools.png").is_file()
    assert (tmp_path / "pipe_tractions.png").is_file()
    film = tmp_path / "pipe.gif"
    assert main(["animate", str(pipe.path), "--output", str(film)]) == 0
    assert film.read_bytes()[:3] == b"GIF"
    assert str(film) in capsys.readouterr().out


def test_tools_move_in_a_film(pipe, tmp_path):
    film = tmp_path / "pipe.mp4"
    assert main(["animate", str(pipe.path), "--output", str(film)]) == 0
    assert film.read_bytes()[4:8] == b"ftyp"


def test_film_without_ffmpeg_is_refused(pipe, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("coulter_post.figures.FFMpegWriter.isAvailable", lambda: False)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    film = tmp_path / "pipe.mp4"
    assert main(["animate", str(pipe.path), "--output", str(film)]) == 1
    assert "needs ffmpeg" in capsys.readouterr().err
    assert not film.exists()


def test_faults_are_told_in_one_line(path, tmp_path, capsys):
    assert main(["summary", str(tmp_path / "none.vtkhdf")]) == 1
    assert main(["figures", str(path), "--steps", "9", "--output", str(tmp_path)]) == 1
    (first, second) = capsys.readouterr().err.strip().splitlines()
    assert "no results file" in first and "no frame of step 9" in second
