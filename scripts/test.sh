#!/usr/bin/env bash
# Test from a bare clone: install what is missing, build with warnings as errors, run every test,
# then the unit tests again with all run-time checks. The last line counts the tests.
# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

# A build that fails half-way goes on: what is missing counts as a failed test.
# run_tests PRESET [CTEST OPTIONS]
run_tests() {
   phase "test $1" ctest --test-dir "$root/build/$1" --parallel "$(nproc)" --output-on-failure \
      --test-output-size-passed 1000000 --test-output-size-failed 1000000 \
      --output-junit "$root/build/$1/tests.xml" "${@:2}"
}

install_packages "${build_packages[@]}"
install_python postproc/requirements.txt tests/requirements.txt

rm -f "$root"/build/*/tests.xml
for preset in release debug; do
   configure "$preset" -DCOULTER_WERROR=ON || continue
   build "$preset" -- -k 0 || true
   if [ "$preset" = release ]; then
      run_tests release || true
   else
      run_tests debug --label-regex unit || true
   fi
done

"$root/.venv/bin/python" "$root/scripts/count_tests.py" \
   "$root/build/release/tests.xml" "$root/build/debug/tests.xml"
