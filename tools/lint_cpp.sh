#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Checks the C++ sources: format by .clang-format, names by .clang-tidy. $1: folder of the two tools.
set -eu
sources=$(git ls-files 'native/*.cpp' 'native/*.hpp' 2>/dev/null || find native -name '*.[ch]pp')
"$1/clang-format" --dry-run --Werror $sources
printf '%s\n' native/core/*.cpp native/core/lateral/*.cpp native/core/lateral_walks/*.cpp | xargs -n 6 -P 2 sh -c '"$0" --quiet "$@" -- -std=c++20 -x c++ -Inative/core \
    -isystem /usr/include/eigen3 -isystem build/embree/include -DEIGEN_DONT_PARALLELIZE 2>/dev/null' "$1/clang-tidy"
