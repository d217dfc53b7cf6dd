#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the README's first command in a bare Debian 12 with only the packages that the README names, in a clone of the
# last commit, as a user with sudo: tools/test_first_command.sh PYTHON [ARGUMENT OF MAKE ...]
# PYTHON's pip says how packages are reached. The pictures are copied to build/first-command.
# Passes, after one sentence, where this machine allows no such root folder.
set -eu

python="$1" work="$PWD/build/first-command"
shift
tools/debian_root.sh bookworm build/debian-bookworm git make gcc cmake python3.11 sudo || { [ $? = 3 ] && exit 0; exit 1; }

root="$work/root" home="$work/root/home/user"
rm -rf --one-file-system "$work"
mkdir -p "$work"
trap 'rm -rf --one-file-system "$root"' EXIT
trap 'exit 1' HUP INT TERM
cp -a --reflink=auto "$(readlink -f build/debian-bookworm)" "$root"
cp /etc/resolv.conf "$root/etc/"
echo "127.0.1.1 $(uname -n)" >>"$root/etc/hosts"
chroot "$root" useradd --create-home user
git clone --quiet --depth 1 "file://$PWD" "$home/lamina"

# The settings of this machine's pip and its proxies, as variables; and the user's cache, with Embree and pip's downloads.
{
    "$python" -m pip config list | awk -F= '!/find-links/ { name = toupper($1); sub(/.*\./, "", name); gsub("-", "_", name)
        print "export PIP_" name substr($0, length($1) + 1) }'
    env | grep -iE '^(https?|no)_proxy=' | sed "s/'/'\\\\''/g; s/=\(.*\)/='\1'/; s/^/export /" || true
} >"$home/environment"
certificates=$(. "$home/environment" && echo "${PIP_CERT:-${REQUESTS_CA_BUNDLE:-${SSL_CERT_FILE:-}}}")
[ ! -f "$certificates" ] || {
    cp "$certificates" "$home/certificates.pem"
    echo "export PIP_CERT=/home/user/certificates.pem" >>"$home/environment"
}
printf '%s\n' 'user ALL=(ALL) NOPASSWD: ALL' 'Defaults env_keep += "http_proxy https_proxy no_proxy"' \
    >"$root/etc/sudoers.d/user"
cache="${LAMINA_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/lamina}/first-command"
mkdir -p "$cache" "$home/.cache"
chroot "$root" chown -R user: /home/user
chown "$(stat -c %u:%g "$home")" "$cache"

echo "make demo $* in a bare Debian 12"
unshare --mount --pid --fork --kill-child sh -euc '
    mount -t proc proc "$1/proc" && mount --rbind /dev "$1/dev" && mount --bind "$2" "$1/home/user/.cache"
    root=$1 && shift 2
    exec chroot --userspec=user "$root" env -i HOME=/home/user USER=user PATH=/usr/local/bin:/usr/bin:/bin \
        sh -euc ". ~/environment && cd ~/lamina && exec make demo \"\$@\"" sh "$@"' sh "$root" "$cache" "$@"
cp "$home"/lamina/demo_scenes/out/*.png "$work"
test -s "$work/slab.png" && test -s "$work/slab_baked.png"
