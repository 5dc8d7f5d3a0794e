#!/bin/sh
# make.sh PHOTONBENCH [SCENE...]   makes the stored references anew: of each scene without an exact answer its image by
# the path tracer (NAME.exr) and that image's standard error over its mean (NAME.error.exr). Each says in its header by
# which command, version and seed it was made. Minutes a scene on two cores. Where few paths find the light images are
# small and have many samples; in the maze each sample asks 256 lamps.
set -eu
program=$1
shift
here=$(dirname "$0")
[ $# -gt 0 ] || set -- cornell cornell-diffuse cornell-water four-lights fractal-cornell cognac torus lamp \
    egg office maze wide-floor
for scene in "$@"; do
    name=$(echo "$scene" | tr - _)
    case $scene in
    torus | lamp) size=32x32 spp=524288 ;;
    egg) size=32x32 spp=131072 ;;
    office) size=64x64 spp=8192 ;;
    maze) size=64x64 spp=2048 ;;
    wide-floor) size=32x32 spp=262144 ;;
    *) size=128x128 spp=4096 ;;
    esac
    "$program" render "$scene" --method path --size $size --spp $spp --trials 1 --seed 2002 --aov --half --quiet \
        -o "$here/$name.exr"
    mv "$here/$name.noise.exr" "$here/$name.error.exr"
done
