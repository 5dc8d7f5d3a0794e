#!/bin/sh
# threads.sh BUILD   the unit tests that run things in parallel, and commands on four threads, where BUILD was made with
# the thread sanitizer and OPENMP= (OpenMP's library is not made for it: parallel.c then has threads of its own). Embree
# is not instrumented, and starts no threads here.
set -eu
build=$1
export TSAN_OPTIONS=halt_on_error=1:exitcode=66 CK_TIMEOUT_MULTIPLIER=20
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

part() {
    echo "threads: $*"
    "$@" >"$out/log" 2>&1 || { status=$?; cat "$out/log"; echo "exit status $status"; exit 1; }
}

for source in $(grep -l 'pm__parallel_for\|pthread_create' tests/unit/test_*.c); do
    name=$(basename "$source" .c)
    [ "$name" != test_scene ] || continue # counts the process's threads, and the sanitizer has one of its own
    part "$build/tests/unit/$name"
done
run() {
    part "$build/photonbench" "$@" --threads 4 --quiet
}
run accuracy --case square,volume --k 20 --photons 2000 --trials 4 --probes 64 -o "$out/table"
run accuracy --case scene:plate --k 20 --photons 2000 --trials 4 --probes 64 -o "$out/table"
run render cornell --estimator disc,precomputed:when=demand --size 32x32 --photons 2000 --spp 2 -o "$out/image.exr"
run render cornell --method path --size 32x32 --spp 2 -o "$out/image.exr"
run converge plate --method ppm,sppm,pppm,pm,light,path --passes 3 --trials 2 --photons-per-pass 5000 --size 16x16 \
    -o "$out/table"
run stress --test powers,ties,single --estimator disc,hull,precomputed -o "$out/table"
run search --case square,caustic --photons 20000 --samples 1 --search wide,grid,recursive -o "$out/table"
