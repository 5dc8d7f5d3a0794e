#!/bin/sh
# make.sh PHOTONBENCH [SCENE...]   makes the stored references anew: of each scene without an exact answer its image by
# the path tracer (NAME.exr) and that image's standard error over its mean (NAME.error.exr). Each says in its header by
# which command, version and seed it was made. Minutes a scene on two cores. torus and lamp are small and have many
# samples: few of their paths find the light.
set -eu
program=$1
shift
here=$(dirname "$0")
[ $# -gt 0 ] || set -- cornell cornell-diffuse cornell-water four-lights fractal-cornell cognac torus lamp
for scene in "$@"; do
    name=$(echo "$scene" | tr - _)
    case $scene in
    torus | lamp) size=32x32 spp=524288 ;;
    *) size=128x128 spp=4096 ;;
    esac
    "$program" render "$scene" --method path --size $size --spp $spp --trials 1 --seed 2002 --aov --half --quiet \
        -o "$here/$name.exr"
    mv "$here/$name.noise.exr" "$here/$name.error.exr"
done
