"""The last line of scripts/test.sh counts what has run, and misses no failure."""
import os
import subprocess
import sys
from pathlib import Path
from xml.sax.saxutils import escape

import pytest

SCRIPT = Path(os.environ["COULTER_SOURCE_DIR"]) / "scripts" / "count_tests.py"


def count(tmp_path, *files, options=()):
    """Last line and exit status for files given as lists of (name, status, output)."""
    paths = []
    for i, rows in enumerate(files):
        paths.append(tmp_path / f"{i}.xml")
        cases = "".join(f'<testcase name="{name}" status="{status}"><system-out>{escape(output)}'
                        "</system-out></testcase>" for name, status, output in rows)
        paths[-1].write_text(f"<testsuite>{cases}</testsuite>", encoding="utf-8")
    result = subprocess.run([sys.executable, SCRIPT, *options, *paths],
                            capture_output=True, text=True, check=False)
    return result.stdout.splitlines()[-1], result.returncode


@pytest.mark.parametrize("status, output, line", [
    ("run", " OK (12 tests, 1 disabled)\n", "12 passed, 0 failed"),
    ("fail", "x.pf:1: failure\nFAILED (12 tests, 2 failures)\n", "10 passed, 2 failed"),
    ("run", ".......\nTime: 0.0 seconds\n OK\n (7 tests)\n", "7 passed, 0 failed"),
    ("fail", " FAILURES!!!\nTests run: 3, Failures: 1, Errors: 1\n", "1 passed, 2 failed"),
    ("run", ".....\n5 passed in 0.10s\n", "5 passed, 0 failed"),
    ("fail", "1 failed, 4 passed, 1 skipped, 2 errors in 1.20s\n", "4 passed, 3 failed"),
    ("fail", " OK (3 tests)\n", "0 passed, 1 failed"),     # crashed at its end
    ("fail", "Segmentation fault", "0 passed, 1 failed"),
    ("run", "", "0 passed, 1 failed"),                     # stopped before its end
    ("notrun", "Unable to find executable", "0 passed, 1 failed"),
])
def test_one_row(tmp_path, status, output, line):
    assert count(tmp_path, [("row", status, output)]) == (line, int(not line.endswith(" 0 failed")))


def test_a_row_in_two_builds_counts_once_with_its_worst_outcome(tmp_path):
    release = [("a", "run", " OK (3 tests)"), ("b", "run", " OK (2 tests)")]
    debug = [("a", "fail", "FAILED (3 tests, 1 failures)")]
    assert count(tmp_path, release, debug) == ("4 passed, 1 failed", 1)


def test_nothing_run_is_no_success(tmp_path):
    assert count(tmp_path, []) == ("0 passed, 0 failed", 1)


def test_a_broken_build_is_a_failure(tmp_path):
    good = [("a", "run", " OK (3 tests)")]
    options = ["--broken", "build of debug"]
    assert count(tmp_path, good, options=options) == ("3 passed, 1 failed", 1)
