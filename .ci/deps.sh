#!/bin/sh
# deps.sh install|name SET...   what the SETs (build, check, bench) need from Debian's packages.
# install: installs what is missing when run as root; else names the one apt line and fails.
# name: installs nothing; names the line and fails if something is missing.
# Nothing is done, and nothing printed, when nothing is missing.
set -eu

mode=$1
shift
wanted="libc6-dev pkg-config libjansson-dev librandom123-dev"
for set in "$@"; do
    [ "$set" != check ] || wanted="$wanted check libgsl-dev libmpfr-dev"
    [ "$set" != bench ] || wanted="$wanted g++ libnanoflann-dev libflann-dev liblz4-dev libann-dev libcgal-dev libembree-dev libtbb-dev"
done
command -v "${CC:-cc}" >/dev/null 2>&1 || wanted="gcc $wanted"

if ! command -v dpkg-query >/dev/null 2>&1; then
    exit 0 # not Debian: the compiler will say what is missing
fi
missing=
for package in $wanted; do
    case $(dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null || true) in
    ii*) ;;
    *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0

line="apt-get install -y --no-install-recommends$missing"
if [ "$mode" = install ] && [ "$(id -u)" = 0 ]; then
    echo "Installing$missing"
    apt-get update -q
    DEBIAN_FRONTEND=noninteractive $line
    exit 0
fi
echo "Missing Debian packages. Install them with:" >&2
echo "    sudo $line" >&2
exit 1
