"""What the log of a run says in its summary."""
import os
import subprocess
from pathlib import Path

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
