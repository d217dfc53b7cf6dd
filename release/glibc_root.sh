#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Unpacks the C and C++ libraries of Debian 11 (glibc 2.31) into the folder $2, for the processor $1: amd64 or arm64. The
# wheels for Linux are tested with them. The machine's own list of packages stays as it is, and nothing is installed.
set -eu

architecture="$1"
root="$2"
[ ! -e "$root/done" ] || exit 0

mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Created-By: Packages' 2>/dev/null |
    awk '$2 == "bookworm" { print $1; exit }')
if [ -z "$mirror" ]; then
    echo "release: apt knows no archive of Debian to get glibc 2.31 from" >&2
    exit 1
fi
rm -rf "$root"
mkdir -p "$root/apt/lists/partial" "$root/apt/cache/archives/partial" "$root/apt/packages"
echo "deb [arch=$architecture signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bullseye main" \
    >"$root/apt/sources.list"
set -- -qq -o APT::Architecture="$architecture" -o APT::Architectures="$architecture" -o APT::Sandbox::User=root \
    -o Dir::Etc::SourceList="$root/apt/sources.list" -o Dir::Etc::SourceParts=- -o Dir::State::Lists="$root/apt/lists" \
    -o Dir::State::Status=/dev/null -o Dir::Cache="$root/apt/cache" -o Acquire::Retries=3
apt-get "$@" update
(cd "$root/apt/packages" && apt-get "$@" download libc6 libgcc-s1 libstdc++6 zlib1g libffi7)
for package in "$root"/apt/packages/*.deb; do
    dpkg-deb -x "$package" "$root"
done
rm -rf "$root/apt"
touch "$root/done"
