#!/usr/bin/env bash
# Compile an Abaqus UMAT to a shared library that a deck can name:
#
#    scripts/build_umat.sh SOURCE [LIBRARY] [COMPILER OPTIONS]
#
# SOURCE is fixed (.f, .for) or free form (.f90); LIBRARY is SOURCE with the ending .so unless given.
# FC chooses the compiler, gfortran by default.
set -euo pipefail

if [ $# -lt 1 ]; then
   echo "usage: build_umat.sh SOURCE [LIBRARY] [COMPILER OPTIONS]" >&2
   exit 2
fi
source=$1
shift
library=${source%.*}.so
case ${1:--} in
   -*) ;;
   *) library=$1; shift ;;
esac
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# ABA_PARAM.INC goes by either case
include=$(mktemp -d)
trap 'rm -r "$include"' EXIT
cp "$root/include/umat/ABA_PARAM.INC" "$include/ABA_PARAM.INC"
cp "$root/include/umat/ABA_PARAM.INC" "$include/aba_param.inc"

"${FC:-gfortran}" -shared -fPIC -O2 -g -std=legacy -I"$include" "$@" -o "$library" "$source"
