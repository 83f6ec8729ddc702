"""The layers of src/ hold, and the script that says so notices when they do not."""
import os
from pathlib import Path

import pytest
from check_layers import check

SOURCE = Path(os.environ["COULTER_SOURCE_DIR"]) / "src"

GOOD = {
    "base/kinds.f90": "module coulter_base_kinds\nuse, intrinsic :: iso_c_binding, only: c_int",
    "grid/grid.f90": "module coulter_grid\nuse coulter_base_kinds, only: &\n   & wp ! use nothing",
    "law/elastic.f90": "module coulter_law_elastic\nuse coulter_base_kinds, only: wp",
    "points/points.f90": "module coulter_points\nuse coulter_grid, only: grid_type",
    "boundary/wall.f90": "module coulter_boundary_wall\nuse coulter_points, only: points_type",
    "model/model.f90": "module coulter_model\nuse coulter_boundary_wall, only: wall_type",
    "system/system.f90": "module coulter_system\nuse coulter_model, only: model_type",
    "newton/newton.f90": "module coulter_newton\nuse coulter_system, only: system_type",
    "step/run.f90": "module coulter_step_run\nuse coulter_newton, only: solve_newton",
    "results/frames.f90": "module coulter_results_frames\nuse hdf5, only: hid_t\nstop_now = 1",
    "main.f90": "program coulter\nuse coulter_step_run, only: run\nif (failed) stop 1",
}


def faults_of(tmp_path, files):
    for name, text in (GOOD | files).items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text + "\n", encoding="utf-8")
    return check(tmp_path)


def test_our_source_holds():
    assert check(SOURCE) == []


def test_a_good_tree_holds(tmp_path):
    assert faults_of(tmp_path, {}) == []


@pytest.mark.parametrize("name, line, fault", [
    ("base/x.f90", "use coulter_grid, only: a", "base/ must not use grid/"),
    ("base/x.f90", "use coulter_version, only: version", "base/ knows nothing of the version"),
    ("grid/x.f90", "use coulter_law_elastic, only: a", "grid/ must not use law/"),
    ("law/x.f90", "use coulter_grid, only: a", "law/ must not use grid/"),
    ("points/x.f90", "use :: coulter_boundary_wall, &\n only: a", "points/ must not use boundary/"),
    ("model/x.f90", "use coulter_step_run, only: a", "model/ must not use step/"),
    ("system/x.f90", "use coulter_newton, only: a", "system/ must not use newton/"),
    ("results/x.f90", "use coulter_system, only: a", "results/ must not use system/"),
    ("deck/x.f90", "use coulter_step_run, only: a", "deck/ must not use step/"),
    ("deck/x.f90", "use coulter_results_frames, only: a", "deck/ must not use results/"),
    ("results/x.f90", "use coulter_step_run, only: a", "results/ must not use step/"),
    ("step/x.f90", "use coulter_model", "`use coulter_model` without `only`"),
    ("step/x.f90", "use hdf5, only: hid_t", "only results/ knows HDF5"),
    ("step/x.f90", "namelist /control/ a", "only deck/ reads namelists"),
    ("grid/x.f90", 'integer function f() bind(c, name="umfpack_di_solve")',
     "only algebra/ binds the sparse solvers"),
    ("step/x.f90", "error stop", "only main.f90 stops"),
    ("step/x.f90", 'if (a > b) stop "no"', "only main.f90 stops"),
    ("other.f90", "stop", "only main.f90 stops"),
    ("attic/x.f90", "integer :: i", "the folder attic/ is not in the plan"),
    ("step/x.f90", "use coulter_model_modle, only: a", "no file of src/ is named for"),
])
def test_a_bad_line_is_found(tmp_path, name, line, fault):
    module = "coulter_" + name.removesuffix(".f90").replace("/", "_")
    found = faults_of(tmp_path, {name: f"module {module}\n{line}"})
    assert len(found) == 1
    assert fault in found[0]


def test_a_module_is_named_by_its_path(tmp_path):
    found = faults_of(tmp_path, {"law/plastic.f90": "module coulter_plastic"})
    assert "must be named coulter_law_plastic" in found[0]
