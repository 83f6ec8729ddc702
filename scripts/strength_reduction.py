#!/usr/bin/env python3
"""Factor of safety by strength reduction: the largest factor by which strengths can be divided so
that the scene of a deck still finds equilibrium. Cohesions and shear strengths are divided by it,
and so are the tangents of friction and dilation angles (Zienkiewicz, Humpheson and Lewis,
Geotechnique 25 (1975) 671-689).

scripts/strength_reduction.py --program build/release/coulter input/slope/slope.nml

With --keep, decks and results of all factors stay in a directory: the last state of the smallest
factor that falls shows the mechanism.
"""
import argparse
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

DIVIDED = ("cohesion", "shear_strength", "yield_stress", "strength_gradient")
ANGLES = ("friction_angle", "dilation_angle")
ASSIGNMENT = re.compile(
    rf"\b({'|'.join(DIVIDED + ANGLES)})(\s*=\s*)([-+0-9.]+(?:[ed][-+]?[0-9]+)?)", re.IGNORECASE)


def reduced(deck, factor):
    """Text of a deck with all strengths reduced by a factor, and how many those are."""
    count = 0

    def divide(match):
        nonlocal count
        count += 1
        value = float(match[3].lower().replace("d", "e"))
        if match[1].lower() in ANGLES:
            value = math.degrees(math.atan(math.tan(math.radians(value)) / factor))
        else:
            value /= factor
        return f"{match[1]}{match[2]}{value!r}"

    lines = []
    for line in deck.splitlines():
        code, mark, comment = line.partition("!")
        lines.append(ASSIGNMENT.sub(divide, code) + mark + comment)
    return "\n".join(lines) + "\n", count


def largest_displacement(path):
    """In the last frame of a results file."""
    # needed with --growth only
    import h5py

    with h5py.File(path) as results:
        count = int(results["VTKHDF/NumberOfPoints"][-1])
        first = int(results["VTKHDF/Steps/PointOffsets"][-1])
        rows = results["VTKHDF/PointData/displacement"][first:first + count]
    return float((rows**2).sum(axis=1).max() ** 0.5)


class Scene:
    """A deck that is run with ever other factors."""

    def __init__(self, program, deck, growth, folder):
        self.program, self.deck, self.growth, self.folder = program, deck, growth, folder
        self.first_displacement = None

    def stands(self, factor):
        """Does the scene find equilibrium in all its steps, without displacements that have grown
        too much since the first factor? Faults of the deck end the search."""
        path = Path(self.folder) / f"reduced_{factor:.6f}.nml"
        path.write_text(reduced(self.deck, factor)[0], encoding="utf-8")
        result = subprocess.run([self.program, "--quiet", "--output", self.folder, path],
                                capture_output=True, text=True, check=False)
        if result.returncode not in (0, 1):
            sys.exit(result.stderr)
        if result.returncode == 1 or self.growth is None:
            return result.returncode == 0
        displacement = largest_displacement(path.with_suffix(".vtkhdf"))
        if self.first_displacement is None:
            self.first_displacement = displacement
        return displacement <= self.growth * self.first_displacement


def find_factor(program, deck, low, high, accuracy, growth=None, keep=None):
    """Bisect: the largest factor known to stand, and the smallest known not to."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Scene(program, deck, growth, keep or folder)
        for bound, expected in ((low, True), (high, False)):
            if scene.stands(bound) != expected:
                sys.exit(f"the scene {'falls' if expected else 'stands'} at the factor {bound};"
                         f" give a {'smaller --low' if expected else 'larger --high'}")
        while high - low > accuracy:
            middle = 0.5 * (low + high)
            is_standing = scene.stands(middle)
            print(f"{middle:8.4f} {'stands' if is_standing else 'falls'}", flush=True)
            if is_standing:
                low = middle
            else:
                high = middle
    return low, high


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deck", type=Path)
    parser.add_argument("--program", default="coulter", help="default: coulter on the path")
    parser.add_argument("--low", type=float, default=1.0, help="a factor that stands")
    parser.add_argument("--high", type=float, default=2.0, help="a factor that falls")
    parser.add_argument("--accuracy", type=float, default=0.01)
    parser.add_argument("--growth", type=float, help="the scene falls, too, when the largest"
                        " displacement exceeds this many times that at --low")
    parser.add_argument("--keep", type=Path, help="directory for decks and results of all factors")
    options = parser.parse_args()
    if options.keep:
        options.keep.mkdir(parents=True, exist_ok=True)
    deck = options.deck.read_text(encoding="utf-8")
    if reduced(deck, 1.0)[1] == 0:
        sys.exit(f"{options.deck}: no strengths to reduce")
    low, high = find_factor(options.program, deck, options.low, options.high, options.accuracy,
                            options.growth, options.keep)
    print(f"factor of safety {0.5 * (low + high):.3f}, between {low:.4f} and {high:.4f}")


if __name__ == "__main__":
    main()
