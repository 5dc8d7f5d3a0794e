#!/bin/sh
# run.sh BUILD [KIND...]   runs the test programs (all, or those of the kinds), as many at a time as there are
# processors, and prints the totals. Fails if any test fails or no test ran.
set -eu
build=$1
shift
[ $# -gt 0 ] || set -- unit oracle errata stat cli fuzz
jobs=$(nproc 2>/dev/null || echo 1)
logs=$build/test-logs
rm -rf "$logs"
mkdir -p "$logs"

programs=
for kind in "$@"; do
    for source in tests/"$kind"/test_*.c; do
        [ -f "$source" ] || continue
        name=${source#tests/}
        programs="$programs ${name%.c}"
    done
done

# shellcheck disable=SC2086
printf '%s\n' $programs | xargs -P "$jobs" -I{} sh -c '
    log='"$logs"'/$(echo {} | tr / .)
    start=$(date +%s)
    status=0
    '"$build"'/tests/{} >"$log" 2>&1 || status=$?
    echo "seconds $(($(date +%s) - start))" >>"$log"
    [ $status = 0 ] || { echo "exit $status" >>"$log"; }'

passed=0
failed=0
for program in $programs; do
    log=$logs/$(echo "$program" | tr / .)
    line=$(grep -E '^[0-9]+%: Checks: [0-9]+, Failures: [0-9]+, Errors: [0-9]+' "$log" | tail -n 1 || true)
    seconds=$(sed -n 's/^seconds //p' "$log")
    checks=$(echo "$line" | sed -n 's/.*Checks: \([0-9]*\).*/\1/p')
    bad=$(echo "$line" | sed -n 's/.*Failures: \([0-9]*\), Errors: \([0-9]*\).*/\1 \2/p' | awk '{print $1 + $2}')
    if [ -z "$checks" ]; then # died before Check could count
        checks=1
        bad=1
    elif [ "$bad" = 0 ] && grep -q '^exit ' "$log"; then
        bad=1
    fi
    passed=$((passed + checks - bad))
    failed=$((failed + bad))
    printf '%-40s %4d passed %3d failed %4ss\n' "$program" $((checks - bad)) "$bad" "$seconds"
    if [ "$bad" != 0 ]; then
        cat "$log"
    fi
    grep '^SKIP' "$log" || true
done
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
