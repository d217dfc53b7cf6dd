#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs tests on a build with GCC's sanitizers: tools/sanitize.sh address|thread PYTHON [PYTEST OPTION ...]
# address: the core's tests under AddressSanitizer and UndefinedBehaviorSanitizer; thread: the tests that use several
# threads under ThreadSanitizer.
# Python itself is not instrumented, so the sanitizer's runtime is preloaded, and leaks are not looked for.
set -eu
kind="$1"
python="$(cd "$(dirname "$2")" && pwd)/$(basename "$2")"
shift 2
case "$kind" in
address) flags="-fsanitize=address,undefined -fno-sanitize-recover=all" runtimes="libasan.so libubsan.so"
    tests="tests/core" ;;
thread) flags="-fsanitize=thread" runtimes="libtsan.so"
    tests="tests/core/numeric/test_thread_pool.py tests/core/bodies/test_mesh.py
        tests/core/laboratory/test_scattering_walk.py tests/lamina/walks/test_shards.py
        tests/lamina/interior/test_walk_parts.py" ;;
*)
    echo "lamina: sanitize $kind: must be address or thread" >&2
    exit 2
    ;;
esac
build="build/sanitize-$kind"

echo "Building the core with $flags"
# -w: instrumented code causes false warnings (GCC's manual), and the usual build has checked for true ones.
cmake -S . -B "$build" -G Ninja -DCMAKE_MAKE_PROGRAM="$("$python" -c 'import ninja; print(ninja.BIN_DIR)')/ninja" \
    -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O2 -g1 -w -fno-omit-frame-pointer $flags" \
    -DSKBUILD=ON -DCMAKE_STRIP= \
    -DPython_EXECUTABLE="$python" -Dpybind11_DIR="$("$python" -m pybind11 --cmakedir)" >"$build.log" 2>&1 &&
    cmake --build "$build" >>"$build.log" 2>&1 || {
    tail -20 "$build.log" >&2
    exit 1
}
rm -rf "$build/package"
cmake --install "$build" --prefix "$build/package" >/dev/null
cp -r native/lamina/. "$build/package/lamina"

preload=""
for runtime in $runtimes; do
    preload="$preload $(c++ -print-file-name="$runtime")"
done
# The reports are written by C code: pytest would hold them back without --capture=sys, and a sanitizer ends the process.
# ThreadSanitizer needs the memory layout that address-space randomisation disturbs.
export ASAN_OPTIONS=detect_leaks=0 TSAN_OPTIONS="halt_on_error=1 suppressions=$PWD/tools/thread_sanitizer.txt"
# The test that is left out starts processes without the preloaded runtime.
PYTHONPATH="$build/package" LD_PRELOAD="$preload" PYTHONMALLOC=malloc setarch "$(uname -m)" -R \
    "$python" -m pytest $tests -p no:cacheprovider --capture=sys \
    --deselect tests/core/bodies/test_mesh.py::test_without_the_layer_all_else_works_and_dust_says_why "$@"
