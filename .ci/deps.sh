#!/bin/sh
# deps.sh install|name SET...   what the SETs (build, check, full, bench, report) need from Debian's packages.
# install: installs what is missing when run as root; else names the one apt line and fails.
# name: installs nothing; names the line and fails if something is missing.
# Nothing is done, and nothing printed, when nothing is missing.
set -eu

mode=$1
shift
command -v dpkg-query >/dev/null 2>&1 || exit 0 # not Debian: the compiler will say what is missing

# Commands count wherever they come from, headers and libraries by their package.
wanted="libc6-dev libjansson-dev librandom123-dev libembree-dev libopenexr-dev libpng-dev"
missing=
compiler=${CC%% *}
case $compiler in
clang | clang-[0-9]*)
    package=$compiler
    wanted="$wanted libomp${compiler#clang}-dev"
    ;;
gcc-[0-9]*) package=$compiler ;;
cc | gcc) package=gcc ;;
*) package= ;; # not one of Debian's by that name: the build will say what it thinks of it
esac
[ -z "$package" ] || command -v "$compiler" >/dev/null 2>&1 || missing=" $package"
for set in "$@"; do
    [ "$set" != bench ] ||
        wanted="$wanted g++ libnanoflann-dev libflann-dev liblz4-dev libann-dev libcgal-dev libtbb-dev"
    [ "$set" != full ] || wanted="$wanted valgrind libc6-dbg"
    [ "$set" != report ] || wanted="$wanted gnuplot-nox"
    [ "$set" = check ] || continue
    wanted="$wanted check libgsl-dev libmpfr-dev"
    command -v pkg-config >/dev/null 2>&1 || missing="$missing pkg-config"
done
for package in $wanted; do
    case $(dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null || true) in
    ?i*) ;;
    *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0

line="apt-get install -y --no-install-recommends$missing"
if [ "$mode" = install ] && [ "$(id -u)" = 0 ]; then
    echo "Installing$missing"
    export DEBIAN_FRONTEND=noninteractive DEBCONF_NOWARNINGS=yes
    apt-get update -qq
    $line -qq >/dev/null
    exit 0
fi
echo "Missing Debian packages. Install them with:" >&2
echo "    sudo $line" >&2
exit 1
