#!/bin/sh
# run.sh BUILD [KIND...]   runs the test programs (all, or those of the kinds), as many at a time as there are
# processors, a line each as it ends, and prints the totals. Fails if any test fails or no test ran.
set -eu

# row LOGS PROGRAM STATUS SECONDS   counts the checks of a program's log and prints its line.
row() {
    line=$(grep -E '^[0-9]+%: Checks: [0-9]+, Failures: [0-9]+, Errors: [0-9]+' "$1/log" | tail -n 1 || true)
    checks=$(echo "$line" | sed -n 's/.*Checks: \([0-9]*\).*/\1/p')
    bad=$(echo "$line" | sed -n 's/.*Failures: \([0-9]*\), Errors: \([0-9]*\).*/\1 \2/p' | awk '{print $1 + $2}')
    if [ -z "$checks" ]; then # died before Check could count
        checks=1
        bad=1
    elif [ "$bad" = 0 ] && [ "$3" != 0 ]; then
        bad=1
    fi
    [ "$bad" = 0 ] || mv "$1/log" "$1/failed"
    echo "$((checks - bad)) $bad" >"$1/counts"
    printf '%-34s %4d passed %3d failed %4d s\n' "$2" $((checks - bad)) "$bad" "$4"
}

if [ "$1" = --one ]; then # --one BUILD PROGRAM: what the processors do
    folder=$2/test-logs/$3
    mkdir -p "$folder"
    start=$(date +%s)
    status=0
    "$2/tests/$3" >"$folder/log" 2>&1 || status=$?
    [ "$status" = 0 ] || echo "exit status $status" >>"$folder/log"
    row "$folder" "$3" "$status" $(($(date +%s) - start))
    exit 0
fi

build=$1
shift
[ $# -gt 0 ] || set -- stat errata oracle unit faults cli fuzz # the longest first
rm -rf "$build/test-logs"
mkdir -p "$build/test-logs"
for kind in "$@"; do
    for source in tests/"$kind"/test_*.c; do
        [ -f "$source" ] || continue
        name=${source#tests/}
        echo "${name%.c}"
    done
done >"$build/test-logs/programs"

xargs -P "$(nproc 2>/dev/null || echo 1)" -I{} "$0" --one "$build" {} <"$build/test-logs/programs"

passed=0
failed=0
while read -r program; do
    folder=$build/test-logs/$program
    read -r good bad <"$folder/counts"
    passed=$((passed + good))
    failed=$((failed + bad))
    if [ -f "$folder/failed" ]; then
        printf '\n%s:\n' "$program"
        cat "$folder/failed"
    else
        grep '^SKIP' "$folder/log" || true
    fi
done <"$build/test-logs/programs"
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
