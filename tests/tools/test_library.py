"""docs/library.md names modules and public names that there are."""
import os
import re
from pathlib import Path

import pytest

SOURCE = Path(os.environ.get("COULTER_SOURCE_DIR", Path(__file__).parents[2]))
ROW = re.compile(r"^\| (`coulter_.*?) \| (.*?) \| .* \|$", re.MULTILINE)
ROWS = ROW.findall((SOURCE / "docs/library.md").read_text(encoding="utf-8"))


def public_names(module: str) -> set[str]:
    """What a module of src lists as public."""
    for path in (SOURCE / "src").rglob("*.f90"):
        text = path.read_text(encoding="utf-8")
        if re.search(rf"^module {module}$", text, re.MULTILINE):
            lists = re.findall(r"^ +public :: ((?:.*&\n)*.*)$", text, re.MULTILINE)
            return set(re.findall(r"\w+", " ".join(lists)))
    raise AssertionError(f"no module {module}")


@pytest.mark.parametrize(("modules", "names"), ROWS)
def test_names_are_public(modules: str, names: str) -> None:
    known = set().union(*(public_names(module) for module in re.findall(r"`(\w+)`", modules)))
    for name in re.findall(r"`(\w+\*?)`", names):
        pattern = re.compile(name.replace("*", r"\w+"))
        assert any(pattern.fullmatch(other) for other in known), f"{name} is not in {modules}"


def test_there_are_rows() -> None:
    assert len(ROWS) >= 15
