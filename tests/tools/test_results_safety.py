"""What becomes of results on a full disk, and when two runs write to the same file."""

import os
import subprocess
import time
from pathlib import Path

import pytest

h5py = pytest.importorskip("h5py")

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).parents[2]))
PROGRAM = os.environ.get("COULTER_PROGRAM", str(SOURCE / "build/release/coulter"))
#: A block whose top is pressed down; a step takes a few milliseconds.
DECK = """
&grid origin = 0.0, 0.0, spacing = 0.05, cells = 60, 30 /
&law name = "stuff", youngs_modulus = 1000.0, poisson_ratio = 0.3 /
&body name = "block", law = "stuff", density = 0.0 /
&region body = "block", rectangle = 0.5, 0.0, 2.5, 1.0 /
&fixity name = "base", side = "bottom", held = "xy" /
&tool name = "plate", shape = "rectangle", size = 3.0, 0.2, position = 1.5, 1.0
      displacement = 0.0, -0.1 /
&steps count = {count} /
"""


#: Preloaded: no file takes more than some bytes, as on a disk that is full then.
FULL_DISK = """
#define _GNU_SOURCE
#include <errno.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

ssize_t pwrite64(int file, const void *bytes, size_t n, off_t at) {
   if (at + n > LARGEST) { errno = ENOSPC; return -1; }
   return syscall(SYS_pwrite64, file, bytes, n, at);
}

ssize_t pwrite(int file, const void *bytes, size_t n, off_t at) {
   return pwrite64(file, bytes, n, at);
}
"""


def start(folder: Path, count: int, **environment: str) -> subprocess.Popen:
    """A run in so many steps."""
    deck = folder / "press.nml"
    deck.write_text(DECK.format(count=count))
    return subprocess.Popen(
        [PROGRAM, str(deck), "--quiet", "--output", str(folder)],
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **environment},
    )


def full_disk(folder: Path, largest: int) -> str:
    """The library to preload."""
    source, library = folder / "full.c", folder / "full.so"
    source.write_text(FULL_DISK)
    define = f"-DLARGEST={largest}"
    subprocess.run(["gcc", "-shared", "-fPIC", define, "-o", library, source], check=True)
    return str(library)


def expect_full_disk(run: subprocess.Popen, file: Path) -> None:
    _, message = run.communicate(timeout=60)
    assert run.returncode == 1, message
    assert message.startswith("coulter: ") and message.count("\n") == 1, message
    assert str(file) in message and "full" in message, message


@pytest.mark.parametrize("kilobytes", [40, 1000, 3000])
def test_full_disk_is_an_error(tmp_path: Path, kilobytes: int) -> None:
    run = start(tmp_path, 20, LD_PRELOAD=full_disk(tmp_path, 1024 * kilobytes))
    expect_full_disk(run, tmp_path / "press.vtkhdf")


def test_full_disk_is_an_error_for_the_table(tmp_path: Path) -> None:
    table = tmp_path / "press_tools.csv"
    table.symlink_to("/dev/full")
    expect_full_disk(start(tmp_path, 4), table)


def test_second_run_keeps_the_file_for_itself(tmp_path: Path) -> None:
    first = start(tmp_path, 100000)
    file = tmp_path / "press.vtkhdf"
    until = time.monotonic() + 30.0
    while not (file.exists() and file.stat().st_size > 0) and time.monotonic() < until:
        time.sleep(0.05)
    second = start(tmp_path, 12)
    _, message = second.communicate(timeout=60)
    _, first_message = first.communicate(timeout=60)
    assert first.returncode == 1
    assert "another run has replaced the file" in first_message
    assert second.returncode == 0, message
    with h5py.File(file, locking=False) as results:
        assert results["history"].attrs["n_rows"] == 12
        assert list(results["history/step"][:]) == list(range(1, 13))
        assert results["provenance"].attrs["status"].startswith(b"finished")


def test_full_disk_is_an_error_for_samples(tmp_path: Path) -> None:
    table = tmp_path / "clay_heavily.csv"
    table.symlink_to("/dev/full")
    deck = SOURCE / "input/point/clay.nml"
    command = [PROGRAM, "point", "--quiet", "--output", str(tmp_path), str(deck)]
    run = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    expect_full_disk(run, table)
