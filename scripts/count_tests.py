"""Count the tests in JUnit files written by ctest: `N passed, M failed`, alone on the last line.

    python3 count_tests.py [--broken WHAT] build/release/tests.xml build/debug/tests.xml

A row of ctest is a program of many tests, which says how many in its own output; a row that does
not say so, a missing file and everything named as broken count as one failed test each. A row that
appears in several files counts once, with its worst outcome. The exit status is not zero if a test
failed or none ran.
"""
import argparse
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def count(output):
    """(passed, failed) by what the substitute, pFUnit or pytest has printed; None if nothing."""
    if match := re.search(r"^ OK\s+\((\d+) tests?\b", output, re.MULTILINE):  # ours and pFUnit's
        return int(match[1]), 0
    if match := re.search(r"^FAILED \((\d+) tests, (\d+) failures\)", output, re.MULTILINE):
        return int(match[1]) - int(match[2]), int(match[2])
    if match := re.search(r"Tests run: (\d+), Failures: (\d+), Errors: (\d+)", output):  # pFUnit
        failed = int(match[2]) + int(match[3])
        return int(match[1]) - failed, failed
    if summaries := re.findall(r"^.*\d+ \w+ in [\d.]+s\b", output, re.MULTILINE):  # pytest
        number = {word: int(n) for n, word in re.findall(r"(\d+) ([a-z]+?)s?\b", summaries[-1])}
        return number.get("passed", 0), number.get("failed", 0) + number.get("error", 0)
    return None


def rows(path):
    """Name and (passed, failed) of every row of one file."""
    for row in ElementTree.parse(path).iter("testcase"):
        outcome = count(row.findtext("system-out") or "")
        is_good = row.get("status") == "run"
        if outcome is None or (not is_good and outcome[1] == 0):
            outcome = (0, 1)  # crashed, stopped, timed out or not built
        yield row.get("name"), outcome


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--broken", action="append", default=[])
    parser.add_argument("files", nargs="+", type=Path)
    arguments = parser.parse_args()

    worst = {what: (0, 1) for what in arguments.broken}
    for path in arguments.files:
        for name, outcome in rows(path) if path.exists() else [(f"{path} is missing", (0, 1))]:
            worst[name] = max(worst.get(name, (0, 0)), outcome, key=lambda each: (each[1], each[0]))
    passed = sum(outcome[0] for outcome in worst.values())
    failed = sum(outcome[1] for outcome in worst.values())
    for name, outcome in worst.items():
        if outcome[1] > 0:
            print(f"failed: {name}")
    print(f"{passed} passed, {failed} failed")
    return 1 if failed > 0 or passed == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
