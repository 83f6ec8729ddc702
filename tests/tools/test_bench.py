"""The benchmark runs: decks are accepted, errors are found, figures are drawn."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("numpy")
pytest.importorskip("h5py")
pytest.importorskip("matplotlib")

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).parents[2]))


def test_a_quick_run_finds_small_errors(tmp_path):
    table = tmp_path / "results.csv"
    command = [sys.executable, SOURCE / "bench/run.py", "--quick", "--no-peers"]
    subprocess.run(
        [*command, "--results", table, "--images", tmp_path],
        check=True,
        timeout=200,
        stdout=subprocess.DEVNULL,
    )
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    finest = {row["problem"]: row for row in rows if row["scheme"] == "default"}
    limits = {"column": 0.01, "column_off": 0.01, "patch": 1e-6, "beam": 0.1, "footing": 0.1, "wedge": 0.02}
    for problem, limit in limits.items():
        assert float(finest[problem]["error"]) < limit, problem
        assert float(finest[problem]["cpu_s"]) > 0.0
        assert (tmp_path / f"accuracy_{problem}.png").is_file()


def test_deep_tools_are_listed():
    command = [sys.executable, SOURCE / "bench/penetration.py", "--only", "no such tool"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert done.stdout.startswith("| tool | h |")
