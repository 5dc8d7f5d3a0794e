#!/bin/sh
# make.sh PHOTONBENCH [SCENE...]   makes the stored references anew: of each scene without an exact answer its image by
# the path tracer (NAME.exr) and that image's standard error over its mean (NAME.error.exr). Each says in its header by
# which command, version and seed it was made. Minutes a scene on two cores.
set -eu
program=$1
shift
here=$(dirname "$0")
[ $# -gt 0 ] || set -- cornell cornell-diffuse cornell-water four-lights fractal-cornell cognac
for scene in "$@"; do
    name=$(echo "$scene" | tr - _)
    "$program" render "$scene" --method path --size 128x128 --spp 4096 --trials 1 --seed 2002 --aov --half --quiet \
        -o "$here/$name.exr"
    mv "$here/$name.noise.exr" "$here/$name.error.exr"
done
