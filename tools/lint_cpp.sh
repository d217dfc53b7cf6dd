#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Checks the C++ sources: tools/lint_cpp.sh FOLDER [all|changed|includes]     FOLDER has clang-format and clang-tidy
#     all (default)   format by .clang-format, names by .clang-tidy
#     changed         the same, names only in files that differ from the last commit
#     includes        files that include too much or too little, by misc-include-cleaner
# Each header is compiled on its own, so it must include what it needs: as the first include of the file of the same
# name, or by itself where there is none.
set -eu
tools="$1"
what="${2:-all}"
sources=$(git ls-files --cached --others --exclude-standard 'native/*.cpp' 'native/*.hpp' 2>/dev/null ||
    find native -name '*.[ch]pp')
[ "$what" = includes ] || "$tools/clang-format" --dry-run --Werror $sources

units=""
for file in $(printf '%s\n' $sources | grep '^native/core/'); do
    case "$file" in
    *.hpp) [ -f "${file%.hpp}.cpp" ] || units="$units $file" ;;
    *) units="$units $file" ;;
    esac
done
if [ "$what" = changed ]; then
    changed=$(git diff --name-only HEAD && git ls-files --others --exclude-standard)
    units=$(printf '%s\n' $units | grep -xF "$changed" || true)
fi
[ -n "$units" ] || exit 0

checks=""
[ "$what" != includes ] || checks='--checks=-*,misc-include-cleaner'
printf '%s\n' $units | xargs -n 6 -P 2 sh -c 'tidy="$0"; "$tidy" --quiet '"$checks"' "$@" -- -std=c++20 -x c++ \
    -Wno-pragma-once-outside-header -Inative/core -Inative/core/bodies -Inative/core/laboratory \
    -isystem /usr/include/eigen3 -isystem build/embree/include -DEIGEN_DONT_PARALLELIZE 2>/dev/null' "$tools/clang-tidy"
