"""fortitude finds nothing in our Fortran (rules and reasons: fortitude.toml)."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(os.environ["COULTER_SOURCE_DIR"])


def fortitude(*paths):
    program = Path(sys.executable).parent / "fortitude"
    command = [program, "--config", ROOT / "fortitude.toml", "check", "--output-format", "concise"]
    return subprocess.run([*command, *paths], cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("folder", ["src", "tests/support"])
def test_our_fortran_is_clean(folder):
    result = fortitude(folder)
    assert result.returncode == 0, result.stdout + result.stderr


def test_a_hidden_save_is_found(tmp_path):
    (tmp_path / "bad.f90").write_text("""module bad
   implicit none(type, external)
   private
contains
   subroutine count()
      integer :: n = 0
      n = n + 1
   end subroutine count
end module bad
""", encoding="utf-8")
    result = fortitude(tmp_path)
    assert result.returncode == 1
    assert "C081" in result.stdout
