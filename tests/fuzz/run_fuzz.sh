#!/bin/sh
# run_fuzz.sh BUILD SECONDS   runs each libFuzzer target so long, from the inputs kept in tests/fuzz/corpus, with a
# corpus of its own in BUILD/fuzz. Fails at the first input that goes wrong, which stays there as crash-*.
set -eu
export ASAN_OPTIONS=quarantine_size_mb=4 # maps are built by the thousand
for program in "$1"/fuzz/fuzz_*; do
    case $program in *.d | *.log | *.corpus) continue ;; esac
    [ -f "$program" ] || continue
    name=$(basename "$program")
    mkdir -p "$program.corpus"
    echo "$name, $2 s"
    "$program" -max_total_time="$2" -timeout=20 -rss_limit_mb=2048 -max_len=4096 -artifact_prefix="$1/fuzz/$name-" \
        -print_final_stats=1 "$program.corpus" "tests/fuzz/corpus/$name" >"$program.log" 2>&1 ||
        { tail -n 40 "$program.log" && exit 1; }
    grep 'number_of_executed_units' "$program.log"
done
