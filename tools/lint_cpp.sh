#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Checks the C++ sources: format by .clang-format, names by .clang-tidy. $1: folder of the two tools.
set -eu
sources=$(git ls-files 'native/*.cpp' 'native/*.hpp' 2>/dev/null || find native -name '*.[ch]pp')
"$1/clang-format" --dry-run --Werror $sources
"$1/clang-tidy" --quiet native/core/*.cpp -- -std=c++20 -x c++ -Inative/core -isystem /usr/include/eigen3 \
    -isystem build/embree/include -DEIGEN_DONT_PARALLELIZE 2>/dev/null
