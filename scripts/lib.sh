# Steps shared by run.sh and test.sh; sourced, not run. Each step skips what is already there.
# shellcheck shell=bash
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
logs=$root/build/log

# shellcheck disable=SC2034  # used by those who source this
build_packages=(gfortran gcc g++ cmake ninja-build git
   libsuitesparse-dev libopenblas-serial-dev libhdf5-dev python3 python3-venv ca-certificates)

# phase NAME COMMAND...: one line on the screen, the output in build/log, shown if it fails
phase() {
   local name=$1 log
   shift
   log=$logs/${name// /-}.log
   mkdir -p "$logs"
   echo "== $name"
   if ! "$@" > "$log" 2>&1; then
      echo "== $name failed; the end of $log:"
      tail -n 60 "$log"
      return 1
   fi
}

as_root() {
   if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

apt_install() {
   as_root apt-get update
   as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"
}

# install_packages PACKAGE...: Debian packages that are missing
install_packages() {
   local package missing=()
   if ! command -v dpkg-query > /dev/null; then
      echo "== not Debian: please see to the equivalents of $*"
      return
   fi
   for package in "$@"; do
      if ! dpkg-query -W -f '${Status}' "$package" 2> /dev/null | grep -q '^install ok installed$'
      then
         missing+=("$package")
      fi
   done
   if [ ${#missing[@]} -gt 0 ]; then
      phase "install packages" apt_install "${missing[@]}"
   fi
}

make_venv() {
   local python=/usr/bin/python3
   [ -x "$python" ] || python=python3
   "$python" -m venv "$root/.venv"
}

# install_python REQUIREMENTS...: into .venv, once for every content of a requirements file
install_python() {
   local file stamp
   if [ ! -x "$root/.venv/bin/pip" ]; then
      phase "make the Python environment" make_venv
   fi
   for file in "$@"; do
      stamp=$root/.venv/installed-$(sha256sum < "$root/$file" | cut -c1-16)
      if [ ! -e "$stamp" ]; then
         phase "install ${file//\//-}" "$root/.venv/bin/pip" install --disable-pip-version-check \
            -r "$root/$file"
         touch "$stamp"
      fi
   done
}

# configure PRESET [CMAKE OPTIONS]
configure() {
   phase "configure $1" cmake -S "$root" --preset "$@"
}

# build PRESET [CMAKE BUILD OPTIONS]
build() {
   phase "build $1" cmake --build "$root/build/$1" --parallel "$(nproc)" "${@:2}"
}
