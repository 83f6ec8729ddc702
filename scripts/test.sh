#!/usr/bin/env bash
# Test from a bare clone: install what is missing, build with warnings as errors, run every test,
# then those of the code itself again with all run-time checks. The last line counts the tests.
# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

# run_tests PRESET [CTEST OPTIONS]
run_tests() {
   phase "test $1" ctest --test-dir "$root/build/$1" --parallel "$(nproc)" --output-on-failure \
      --test-output-size-passed 1000000 --test-output-size-failed 1000000 \
      --output-junit "$root/build/$1/tests.xml" "${@:2}"
}

# build_and_test PRESET [CTEST OPTIONS]: goes on after an error, which counts as a failed test
build_and_test() {
   configure "$1" -DCOULTER_WERROR=ON || return 0
   build "$1" -- -k 0 || broken+=(--broken "build of $1")
   run_tests "$@" || true
}

install_packages "${build_packages[@]}"
install_python postproc/requirements.txt tests/requirements.txt

rm -f "$root"/build/*/tests.xml
broken=()
build_and_test release
build_and_test debug --label-regex '^(unit|verification)$'

"$root/.venv/bin/python" "$root/scripts/count_tests.py" "${broken[@]}" \
   "$root/build/release/tests.xml" "$root/build/debug/tests.xml"
