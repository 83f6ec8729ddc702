"""Check that src/ keeps to the plan of the house: who may use whom, and who alone may do what.

    python3 tests/tools/check_layers.py src

Prints `file:line: what is wrong` and ends with status 1 if anything is.
"""
import re
import sys
from pathlib import Path

# What each folder may use besides itself: of a chain, all folders before it. Files directly in src/
# (the program) may use all.
CHAIN = ["boundary", "contact", "model", "system", "assembly", "setup", "newton", "retile", "step"]
BELOW_CHAIN = {"base", "algebra", "grid", "law", "points"}
MAY_USE = {
    "base": set(),
    "algebra": {"base"},
    "grid": {"base", "algebra"},
    "law": {"base", "algebra"},
    "points": {"base", "grid"},
    "sample": {"base", "algebra", "law"},
    **{room: BELOW_CHAIN | set(CHAIN[:i]) for i, room in enumerate(CHAIN)},
}
MAY_USE["deck"] = MAY_USE["model"] | {"model", "sample"}
MAY_USE["results"] = MAY_USE["model"] | {"model"}
VERSION_MODULE = "coulter_version"  # written by CMake; for everyone but base

# Statements that belong to one folder alone, as (pattern, folder, reason).
PRIVILEGES = [
    (r"use\s*(,\s*\w+\s*::|::)?\s*(hdf5|h5\w+)\b", "results", "only results/ knows HDF5"),
    (r"namelist\s*/", "deck", "only deck/ reads namelists"),
    (r".*\bbind\s*\(.*name\s*=\s*[\"'](umfpack|cholmod|amd)_", "algebra",
     "only algebra/ binds the sparse solvers"),
    (r"(if\s*\(.*\)\s*)?(error\s+)?stop\b(?!\s*[%=(:,])", "", "only main.f90 stops"),
]


def strip_comment(line):
    """The line without its comment; quoted texts stay."""
    quote = ""
    for i, character in enumerate(line):
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character == "!":
            return line[:i]
    return line


def statements(path):
    """(line number, statement in lower case) of a file, continuation lines joined."""
    joined, start = "", 0
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        code = strip_comment(line).strip().lower()
        if not code:
            continue
        start = start if joined else number
        joined += code.removeprefix("&").removesuffix("&")
        if not code.endswith("&"):
            yield start, joined.strip()
            joined = ""


def module_name(relative):
    """Module name by the path: law/elastic.f90 is coulter_law_elastic, law/law.f90 coulter_law."""
    parts = list(relative.with_suffix("").parts)
    if len(parts) > 1 and parts[-1] == parts[-2]:
        parts.pop()
    return "_".join(["coulter"] + [part for part in parts if part != "coulter"])


def check_use(folder, statement, owners):
    """What is wrong with one `use` statement, or None."""
    match = re.match(r"use\s*(,\s*\w+\s*)?(::)?\s*(\w+)\s*(,\s*only\s*:)?", statement)
    used = match[3]
    if not match[4]:
        return f"`use {used}` without `only`"
    if not used.startswith("coulter") or folder == "":
        return None
    if used == VERSION_MODULE:
        return "base/ knows nothing of the version" if folder == "base" else None
    if used not in owners:
        return f"no file of src/ is named for the module {used}"
    if owners[used] not in MAY_USE.get(folder, set()) | {folder}:
        return f"{folder}/ must not use {owners[used] or 'the program'}{'/' * bool(owners[used])}"
    return None


def check_file(path, relative, owners):
    """Yield (line, what is wrong) for one file."""
    folder = relative.parts[0] if len(relative.parts) > 1 else ""
    is_main = relative == Path("main.f90")
    if folder and folder not in MAY_USE:
        yield 1, f"the folder {folder}/ is not in the plan (MAY_USE in check_layers.py)"
    for number, statement in statements(path):
        match = re.fullmatch(r"module\s+(?!procedure\b)(\w+)", statement)
        if match and match[1] != module_name(relative):
            yield number, f"module {match[1]} must be named {module_name(relative)}, by its path"
        if re.match(r"use\b(?!\s*[=(%])", statement):
            fault = check_use(folder, statement, owners)
            if fault:
                yield number, fault
        for pattern, owner, reason in PRIVILEGES:
            if re.match(pattern, statement) and folder != owner:
                yield number, reason
            elif owner == "" and not is_main and re.match(pattern, statement):
                yield number, reason


def check(source):
    """All faults of a source tree as lines of text."""
    source = Path(source)
    files = {path: path.relative_to(source) for path in sorted(source.rglob("*.f90"))}
    owners = {module_name(relative): relative.parts[0] if len(relative.parts) > 1 else ""
              for relative in files.values()}
    return [f"{path}:{line}: {fault}" for path, relative in files.items()
            for line, fault in check_file(path, relative, owners)]


if __name__ == "__main__":
    faults = check(sys.argv[1])
    print("\n".join(faults) or "the layers hold")
    sys.exit(1 if faults else 0)
