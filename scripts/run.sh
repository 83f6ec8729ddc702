#!/usr/bin/env bash
# Run a deck from a bare clone: install what is missing, build, run, plot.
#
#    scripts/run.sh DECK [OPTIONS OF THE PROGRAM]
#
# Results go to results/<name of the deck>/ unless --output says otherwise.
# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

if [ $# -eq 0 ] || [[ $1 == -* ]]; then
   echo "usage: scripts/run.sh DECK [OPTIONS OF THE PROGRAM]"
   exit 2
fi
if [ ! -r "$1" ]; then
   echo "run.sh: cannot read the deck $1"
   exit 2
fi
deck=$(realpath "$1")
shift
name=$(basename "$deck" .nml)

output=$root/results/$name
options=()
while [ $# -gt 0 ]; do
   if [ "$1" = --output ] && [ $# -gt 1 ]; then
      output=$(realpath -m "$2")
      shift 2
   else
      options+=("$1")
      shift
   fi
done

install_packages "${build_packages[@]}"
install_python postproc/requirements.txt
configure release
build release --target coulter_program

echo "== run $name"
mkdir -p "$output"
"$root/build/release/coulter" "${options[@]}" --output "$output" "$deck"

# a deck may give its results another name
results=$(find "$output" -maxdepth 1 -name '*.vtkhdf' -printf '%T@ %p\n' | sort -n | tail -1 | cut -d' ' -f2-)
[ -n "$results" ] || exit 0  # --check and the like
PYTHONPATH=$root/postproc phase "plot $name" "$root/.venv/bin/python" -m coulter_post figures \
   "$results" --output "$output"

echo "== results: $results (opens in ParaView 5.12 or later)"
find "$output" -maxdepth 1 -name '*.png' -printf '== picture: %p\n' | sort
