#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Unpacks packages of a Debian release into a folder: debian_packages.sh SUITE PROCESSOR FOLDER PACKAGE ...
# PROCESSOR is amd64 or arm64. The wheels for Linux are tested with these C libraries and Pythons. The machine's own list
# of packages stays as it is, and nothing is installed. Exits with 3, after one sentence, where packages cannot be had.
set -eu

suite="$1" architecture="$2" root="$3"
shift 3
[ ! -e "$root/done" ] || exit 0

refuse() {
    echo "release: no packages of Debian $suite for $architecture: $1" >&2
    exit 3
}

command -v apt-get >/dev/null || refuse "this machine has no apt"
mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Created-By: Packages' 2>/dev/null |
    awk '$2 == "bookworm" { print $1; exit }')
[ -n "$mirror" ] || refuse "apt knows no archive of Debian"
rm -rf "$root"
mkdir -p "$root/apt/lists/partial" "$root/apt/cache/archives/partial" "$root/apt/packages"
echo "deb [arch=$architecture signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $suite main" \
    >"$root/apt/sources.list"
apt() {
    apt-get -qq -o APT::Architecture="$architecture" -o APT::Architectures="$architecture" \
        -o APT::Sandbox::User=root -o Dir::Etc::SourceList="$root/apt/sources.list" -o Dir::Etc::SourceParts=- \
        -o Dir::State::Lists="$root/apt/lists" -o Dir::State::Status=/dev/null -o Dir::Cache="$root/apt/cache" \
        -o Acquire::Retries=3 "$@"
}
apt update || refuse "its archive cannot be read"
(cd "$root/apt/packages" && apt download "$@") || refuse "the download failed"
for package in "$root"/apt/packages/*.deb; do
    dpkg-deb -x "$package" "$root"
done
# Newer releases have all libraries under usr. Programs name their loader by its place under lib.
[ -e "$root/lib" ] || ln -s usr/lib "$root/lib"
rm -rf "$root/apt"
touch "$root/done"
