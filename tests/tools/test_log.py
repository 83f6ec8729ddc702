"""What the log of a run says in its summary."""
import os
import re
import subprocess
from pathlib import Path

import h5py
import pytest

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).parents[2]))
PROGRAM = os.environ.get("COULTER_PROGRAM", str(SOURCE / "build/release/coulter"))
DECK = """
&grid origin = 0.0, 0.0, spacing = 0.25, cells = 16, 8 /
&law name = 'clay', youngs_modulus = 1000.0, poisson_ratio = 0.3 /
&body name = 'bed', law = 'clay', density = 0.0 /
&region body = 'bed', rectangle = 0.5, 0.0, 3.5, 1.0 /
&fixity name = 'base', side = 'bottom', held = 'xy' /
&tool name = 'near', shape = 'rectangle', size = 0.5, 0.5, position = 1.0, 1.0
      displacement = 0.0, -0.05 /
&tool name = 'other', shape = 'rectangle', size = 0.5, 0.5, position = {place}
      displacement = 0.0, -0.05 /
&steps count = 2 /
"""


@pytest.mark.parametrize(("place", "is_idle"), [("250.0, 200.0", True), ("3.0, 1.02", False)])
def test_tools_that_meet_nothing_are_named(tmp_path, place, is_idle):
    deck = tmp_path / "deck.nml"
    deck.write_text(DECK.format(place=place), encoding="utf-8")
    log = subprocess.run([PROGRAM, "--output", tmp_path, deck], capture_output=True, text=True,
                         check=True).stdout
    assert ("warning: tool other has met no material" in log) == is_idle
    assert "tool near" not in log


def test_run_ends_after_steps(tmp_path):
    deck = tmp_path / "deck.nml"
    deck.write_text(DECK.format(place="3.0, 1.02").replace("count = 2", "count = 8"), encoding="utf-8")
    log = subprocess.run([PROGRAM, "--output", tmp_path, "--steps", "3", deck], capture_output=True,
                         text=True, check=True).stdout
    assert re.search(r"steps +3 +of 8", log)
    with h5py.File(tmp_path / "deck.vtkhdf") as results:
        assert results["provenance"].attrs["status"] == b"finished"
        assert list(results["history/step"][:]) == [1, 2, 3]
        # loads are those of the whole deck
        assert results["VTKHDF/Steps/Values"][-1] == pytest.approx(3.0 / 8.0)


@pytest.mark.parametrize("number", ["0", "-3", "two", "1.5", "99999999999", None])
def test_number_of_steps_is_checked(tmp_path, number):
    deck = tmp_path / "deck.nml"
    deck.write_text(DECK.format(place="3.0, 1.02"), encoding="utf-8")
    result = subprocess.run([PROGRAM, "--output", tmp_path, deck, "--steps", *([number] if number else [])],
                            capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert f'--steps needs a whole number above 0, not "{number or ""}"' in result.stderr
    assert not (tmp_path / "deck.vtkhdf").exists()
