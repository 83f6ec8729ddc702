"""A faulty deck is rejected: one clear line per fault, exit status 2, nothing written.

Each deck in tests/bad_decks begins with a comment `! expect: ...` per fault, in the order of the
report: what the line must begin with after the name of the file, line number included. A line
`! run: point` has `coulter point` read it.
"""
import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("COULTER_EXE") or os.environ.get("COULTER_PROGRAM")
               or ROOT / "build/release/coulter").resolve()
DECKS = sorted((ROOT / "tests/bad_decks").glob("*.nml"))


def run(deck, output):
    is_point = deck.is_file() and b"\n! run: point\n" in deck.read_bytes()
    command = [PROGRAM, *["point"] * is_point, "--output", output, deck]
    return subprocess.run(command, timeout=60, capture_output=True,
                          text=True, errors="replace", check=False)


def assert_polite(result):
    for word in ("Backtrace", "Fortran runtime error", "Program received signal", "STOP"):
        assert word not in result.stdout + result.stderr


def fault_lines(result, deck):
    name = f"{deck}:"
    lines = [line.removeprefix("coulter: ") for line in result.stderr.splitlines()]
    return [line.removeprefix(name).strip() for line in lines if line.startswith(name)]


@pytest.fixture(name="output")
def output_folder(tmp_path, monkeypatch):
    folder = tmp_path / "results"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.parametrize("deck", DECKS, ids=lambda deck: deck.stem)
def test_faults_are_named(deck, output):
    mark = "! expect: "
    expected = [line.removeprefix(mark) for line in deck.read_text(encoding="utf-8").splitlines()
                if line.startswith(mark)]
    result = run(deck, output)
    found = fault_lines(result, deck)
    assert expected
    assert result.returncode == 2, result.stdout + result.stderr
    assert_polite(result)
    assert [line[:len(text)] for line, text in zip(found, expected)] == expected
    assert len(found) == len(expected), found
    assert not list(output.iterdir())


def test_there_are_many_bad_decks():
    assert len(DECKS) >= 45


UNREADABLE = {
    "samples only": (lambda path: path.write_text("&sample name = 'clay', law = 'clay' /\n",
                                                  encoding="utf-8"),
                     "holds samples and no scene; run it with `coulter point`"),
    "missing": (lambda path: None, "No such file"),
    "a folder": (lambda path: path.mkdir(), "Is a directory"),
    "empty": (lambda path: path.write_text("", encoding="utf-8"), "holds no groups"),
    "only comments": (lambda path: path.write_text("! later\n\n", encoding="utf-8"),
                      "holds no groups"),
    "not text": (lambda path: path.write_bytes(bytes(range(256))), "is not a text file"),
}


@pytest.mark.parametrize("what", UNREADABLE)
def test_unreadable_deck(what, output):
    make, expected = UNREADABLE[what]
    deck = output.parent / "deck.nml"
    make(deck)
    result = run(deck, output)
    assert result.returncode == 2, result.stdout + result.stderr
    assert_polite(result)
    assert any(expected in line for line in fault_lines(result, deck)), result.stderr
    assert not list(output.iterdir())


def test_output_folder_that_cannot_be_written(output):
    deck = ROOT / "input/patch/patch.nml"
    occupied = output / "file"
    occupied.write_text("in the way", encoding="utf-8")
    result = run(deck, occupied / "below")
    assert result.returncode != 0
    assert_polite(result)
    assert str(occupied) in result.stderr
