"""docs/deck.md is what the program prints, and the deck that it shows is a good one."""
import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_EXE") or os.environ.get("COULTER_PROGRAM")
               or ROOT / "build/release/coulter").resolve()
REFERENCE = (ROOT / "docs/deck.md").read_text(encoding="utf-8")


def run(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False)


def test_reference_is_up_to_date():
    result = run("--deck-reference")
    assert result.returncode == 0, result.stderr
    assert result.stdout == REFERENCE


def test_the_deck_shown_is_accepted(tmp_path):
    deck = tmp_path / "shown.nml"
    deck.write_text(re.search(r"```fortran\n(.*?)```", REFERENCE, re.DOTALL)[1], encoding="utf-8")
    result = run("--check", deck)
    assert result.returncode == 0, result.stderr
