#!/bin/sh
# run_fuzz.sh BUILD SECONDS   runs each libFuzzer target so long, as many at a time as there are processors, from the
# inputs kept in tests/fuzz/corpus, with a corpus of its own in BUILD/fuzz. Fails if an input goes wrong, which stays
# there as crash-*.
set -eu
if [ "$1" = --one ]; then # --one BUILD SECONDS NAME: what the processors do
    program=$2/fuzz/$4
    export ASAN_OPTIONS=quarantine_size_mb=4 # maps are built by the thousand
    mkdir -p "$program.corpus"
    status=0
    "$program" -max_total_time="$3" -timeout=20 -rss_limit_mb=2048 -max_len=4096 -artifact_prefix="$2/fuzz/$4-" \
        -print_final_stats=1 "$program.corpus" "tests/fuzz/corpus/$4" >"$program.log" 2>&1 || status=$?
    [ "$status" = 0 ] || tail -n 40 "$program.log"
    inputs=$(sed -n 's/.*number_of_executed_units: *//p' "$program.log")
    printf '%-20s %10s inputs in %s s  %s\n' "$4" "${inputs:-?}" "$3" "$([ "$status" = 0 ] && echo ok || echo FAILED)"
    exit "$status"
fi

for source in tests/fuzz/fuzz_*.c; do
    basename "$source" .c
done | xargs -P "$(nproc 2>/dev/null || echo 1)" -I{} "$0" --one "$1" "$2" {}
