#!/bin/sh
# Makes cornell.png: the box with two spheres by the path tracer, by Jensen's method, and as estimators see its photons.
# Needs build/photonbench and oiiotool (Debian: openimageio-tools).
set -eu
cd "$(dirname "$0")"
program=../../build/photonbench
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
box="render cornell --size 192x192 --quiet"
$program $box --method path --spp 1024 -o "$folder/1.exr"
$program $box --method full --spp 64 --photons 200000 -o "$folder/2.exr"
$program $box --estimator disc --photons 50000 --spp 64 -o "$folder/3.exr"
$program $box --estimator gaussian --photons 50000 --spp 64 -o "$folder/4.exr"
oiiotool "$folder/1.exr" "$folder/2.exr" "$folder/3.exr" "$folder/4.exr" --mosaic:pad=4 4x1 --mulc 0.8 \
    --colorconvert linear sRGB -d uint8 -o cornell.png
