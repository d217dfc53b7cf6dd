#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the rays that dust needs: Embree 3.13.5 as a static library, from Debian's source archive, and makes $1 a
# link to it. What is built is kept outside the clone, under a name made of all that it depends on, and used again.
# Our core needs x86-64-v3 anyway, so everything is compiled once, for that: Embree's own build would compile it for
# several processors and choose at run time, which takes five times as long.
# LAMINA_CACHE: another folder to keep it in. LAMINA_EMBREE_TARBALL: the source, where apt cannot get it.
# LAMINA_TOOLCHAIN: a toolchain file of release/, for another platform than this machine.
set -eu

version=3.13.5
tarball_sha256=1b7c5b6144230ad81b92ece884a2017fbbb433bf5416a6fca9257e0109501c63
link="$1"

toolchain="${LAMINA_TOOLCHAIN:-}"

if [ -z "$toolchain" ] && [ "$(uname -m)" != x86_64 ]; then
    echo "lamina: no Embree for $(uname -m): dust will not settle, all else works" >&2
    exit 0
fi

cache="${LAMINA_CACHE:-${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}/lamina}"
if ! mkdir -p "$cache" 2>/dev/null || [ ! -w "$cache" ]; then
    cache="$PWD/build/cache"
    mkdir -p "$cache"
fi
if [ -n "$toolchain" ]; then
    compiler() { cat "$toolchain" "$(dirname "$toolchain")/zig.cmake"; "$LAMINA_ZIG" version; }
else
    compiler() { c++ -dumpfullversion; c++ -dumpmachine; }
fi
key=$({ cat "$0"; compiler; } | sha256sum | cut -c1-16)
installed="$cache/embree-$key"

place_link() {
    mkdir -p "$(dirname "$link")"
    ln -sfn "$installed" "$link"
}

if [ -f "$installed/include/embree3/rtcore.h" ]; then
    place_link
    exit 0
fi

work=$(mktemp -d "$cache/building.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

fetch_source() { # the original tarball into $work; the machine's own list of sources stays as it is
    if [ -n "${LAMINA_EMBREE_TARBALL:-}" ]; then
        cp "$LAMINA_EMBREE_TARBALL" "$work/embree.orig.tar.xz"
        return
    fi
    mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Created-By: Packages' 2>/dev/null |
        awk '$2 == "bookworm" { print $1; exit }')
    if [ -z "$mirror" ]; then
        echo "lamina: apt knows no archive of Debian 12 to get Embree's source from: give LAMINA_EMBREE_TARBALL" >&2
        exit 1
    fi
    mkdir -p "$work/apt/lists/partial" "$work/apt/cache/archives/partial" "$work/apt/source"
    echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]" \
        "$mirror bookworm main" >"$work/apt/sources.list"
    set -- -qq -o Dir::Etc::SourceList="$work/apt/sources.list" -o Dir::Etc::SourceParts=- \
        -o Dir::State::Lists="$work/apt/lists" -o Dir::Cache="$work/apt/cache" -o APT::Sandbox::User=root \
        -o Acquire::Retries=3
    apt-get "$@" update
    (cd "$work/apt/source" && apt-get "$@" source --download-only --tar-only embree >/dev/null)
    mv "$work"/apt/source/embree_*.orig.tar.xz "$work/embree.orig.tar.xz"
}

echo "Building Embree $version (rays for dust; once, two to three minutes on two cores)"
fetch_source
echo "$tarball_sha256  $work/embree.orig.tar.xz" | sha256sum --check --quiet
mkdir "$work/source"
tar -xf "$work/embree.orig.tar.xz" -C "$work/source" --strip-components 1

# Curves are left out, for they take half of the time even when they are switched off.
sed -i -e '/^ *geometry\/curve_intersector_virtual_[48][vi_mb]*\.cpp$/d' \
    -e '/^ *bvh\/bvh_builder_hair[_mb]*\.cpp$/d' "$work/source/kernels/CMakeLists.txt"
# Two functions that print use members that do not exist, which Clang refuses even where nobody calls them.
sed -i '/"QuadraticBezierCurve ( (" <</s/a.u.lower << ", " << a.u.upper/a.v0/' "$work/source/kernels/subdiv/bezier_curve.h"
sed -i '/"Line" << M <</s/line.v0 << ", " << //' "$work/source/kernels/geometry/pointi.h"
case "$toolchain" in
*arm64.cmake)
    set -- -DEMBREE_ARM=ON -DEMBREE_MAX_ISA=NEON
    ;;
*)
    # The lowest processor's files are the only ones, with the two that only wider ones have, and what it leaves to
    # wider ones.
    sed -i 's#^  bvh/bvh_intersector1_bvh4.cpp$#&\n  bvh/bvh_intersector1_bvh8.cpp\n  geometry/primitive8.cpp#' \
        "$work/source/kernels/CMakeLists.txt"
    sed -i 's/^#if !defined(__AVX__) || .*EMBREE_TARGET_SSE2.*/#if 1/' \
        "$work/source/kernels/bvh/bvh.cpp" "$work/source/kernels/bvh/bvh_statistics.cpp"
    set -- -DEMBREE_MAX_ISA=NONE -DEMBREE_ISA_SSE2=ON -DEMBREE_ISA_SSE42=OFF -DEMBREE_ISA_AVX=OFF \
        -DEMBREE_ISA_AVX2=OFF -DEMBREE_ISA_AVX512=OFF "-DFLAGS_SSE2=-mf16c -mavx2 -mfma -mlzcnt -mbmi -mbmi2"
    ;;
esac
if [ -n "$toolchain" ]; then
    # The toolchain file names the oldest macOS, and a static library takes no resource file of Windows.
    sed -i '/embree\.rc/d' "$work/source/kernels/CMakeLists.txt"
    sed -i '/-mmacosx-version-min/d' "$work/source/common/cmake/clang.cmake"
    set -- "$@" -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DEMBREE_IGNORE_CMAKE_CXX_FLAGS=OFF
fi

cmake "$@" -S "$work/source" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$work/installed" \
    -DCMAKE_INSTALL_LIBDIR=lib -DEMBREE_STATIC_LIB=ON -DEMBREE_TASKING_SYSTEM=INTERNAL -DEMBREE_ISPC_SUPPORT=OFF \
    -DEMBREE_TUTORIALS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DEMBREE_RAY_PACKETS=OFF -DEMBREE_FILTER_FUNCTION=OFF \
    -DEMBREE_RAY_MASK=OFF -DEMBREE_GEOMETRY_CURVE=OFF -DEMBREE_GEOMETRY_SUBDIVISION=OFF \
    -DEMBREE_GEOMETRY_POINT=OFF -DEMBREE_GEOMETRY_GRID=OFF -DEMBREE_GEOMETRY_QUAD=OFF -DEMBREE_GEOMETRY_USER=OFF \
    -DEMBREE_GEOMETRY_INSTANCE=OFF >"$work/log" 2>&1 &&
    cmake --build "$work/build" --parallel 2 >>"$work/log" 2>&1 &&
    cmake --install "$work/build" --component devel >>"$work/log" 2>&1 || {
    grep -iE -m 5 'error:|undefined' "$work/log" >&2 || true
    tail -5 "$work/log" >&2
    echo "lamina: Embree could not be built" >&2
    exit 1
}

finish() { # keeps what was built; another build may have been quicker
    mv -T "$work/installed" "$installed" 2>/dev/null || [ -f "$installed/include/embree3/rtcore.h" ]
    place_link
}

if [ -n "$toolchain" ]; then # lamina._mesh traces a ray when it is imported there
    finish
    exit 0
fi

# A static library may lack what nobody misses until it is loaded: link it, and trace a ray that must hit.
cat >"$work/ray.cpp" <<'PROGRAM'
#include <embree3/rtcore.h>
#include <limits>
int main() {
  RTCDevice device = rtcNewDevice("threads=1");
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION) != RTC_VERSION) return 1;
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3));
  auto* t = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 1));
  for (unsigned i = 0; i < 9; ++i) v[i] = i == 3 || i == 7;
  for (unsigned i = 0; i < 3; ++i) t[i] = i;
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcCommitScene(scene);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = {.25F, .25F, 1, 0, 0, 0, -1, 0, std::numeric_limits<float>::infinity(), ~0U, 0, 0};
  rtcOccluded1(scene, &context, &ray);
  return ray.tfar < 0 ? 0 : 2;
}
PROGRAM
lib="$work/installed/lib"
c++ -I "$work/installed/include" "$work/ray.cpp" -o "$work/ray" -L "$lib" -lembree3 -lsys -lmath -lsimd -llexers \
    -ltasking -lpthread -ldl
"$work/ray" || {
    echo "lamina: the Embree that was built does not trace rays on this processor" >&2
    exit 1
}

finish
