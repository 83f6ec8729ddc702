"""Count the tests in JUnit files written by ctest: `N passed, M failed`, alone on the last line.

    python3 count_tests.py build/release/tests.xml build/debug/tests.xml

A row of ctest is a program of many tests, which says how many in its own output; a row that fails
without saying so counts as one failed test. A row that appears in several files counts once, with
its worst outcome. The exit status is not zero if a test failed or none ran.
"""
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def count(output):
    """(passed, failed) by the summary that the substitute, pFUnit or pytest has printed."""
    if match := re.search(r"^ OK \((\d+) tests?\b", output, re.MULTILINE):
        return int(match[1]), 0
    if match := re.search(r"^FAILED \((\d+) tests, (\d+) failures\)", output, re.MULTILINE):
        return int(match[1]) - int(match[2]), int(match[2])
    if match := re.search(r"^ OK\s+\((\d+) tests?\b", output, re.MULTILINE):  # pFUnit
        return int(match[1]), 0
    if match := re.search(r"Tests run: (\d+), Failures: (\d+), Errors: (\d+)", output):  # pFUnit
        failed = int(match[2]) + int(match[3])
        return int(match[1]) - failed, failed
    summary = re.findall(r"^.* in [\d.]+s\b.*$", output, re.MULTILINE)  # pytest
    number = {word: int(n) for n, word in re.findall(r"(\d+) (passed|failed|error)", summary[-1])} \
        if summary else {}
    return number.get("passed", 0), number.get("failed", 0) + number.get("error", 0)


def rows(path):
    """Name and (passed, failed) of every row of one file."""
    for row in ElementTree.parse(path).iter("testcase"):
        passed, failed = count(row.findtext("system-out") or "")
        if row.get("status") != "run" and failed == 0:
            passed, failed = 0, 1  # crashed, timed out or not built
        yield row.get("name"), (passed, failed)


def main(paths):
    worst = {}
    for path in paths:
        found = rows(path) if Path(path).exists() else [(f"{path} is missing", (0, 1))]
        for name, outcome in found:
            if outcome[1] > 0:
                print(f"failed: {name}")
            worst[name] = max(worst.get(name, (0, 0)), outcome, key=lambda each: (each[1], each[0]))
    passed = sum(outcome[0] for outcome in worst.values())
    failed = sum(outcome[1] for outcome in worst.values())
    print(f"{passed} passed, {failed} failed")
    return 1 if failed > 0 or passed == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
