#!/bin/sh
# widths.sh BUILD   the tests of what has SIMD code, once by each width that the processor has.
set -eu
for width in v2 avx2 avx512; do
    if ! PHOTONBENCH_SIMD=$width "$1/photonbench" stress --test single --estimator disc --quiet -o /dev/null; then
        echo "SKIP: no $width here"
        continue
    fi
    echo "width $width"
    PHOTONBENCH_SIMD=$width tests/run.sh "$1" unit oracle
done
