#!/bin/sh
# valgrind.sh BUILD [TEST...]   the unit tests (or those named) under valgrind's memory checker, as many at a time as
# there are processors; some hours of a processor. Fails if one reads what is not there or was never written, or leaks.
set -eu
if [ "$1" = --one ]; then # --one PROGRAM: what the processors do
    log=$(mktemp)
    status=0
    start=$(date +%s)
    CK_TIMEOUT_MULTIPLIER=100 valgrind --quiet --leak-check=full --show-leak-kinds=definite \
        --errors-for-leak-kinds=definite --error-exitcode=9 "$2" >"$log" 2>&1 || status=$?
    printf 'valgrind %-40s %5d s  %s\n' "$(basename "$2")" $(($(date +%s) - start)) \
        "$([ "$status" = 0 ] && echo ok || echo "status $status")"
    [ "$status" = 0 ] || cat "$log"
    rm -f "$log"
    exit "$status"
fi

build=$1
shift
if [ $# = 0 ]; then
    for source in tests/unit/test_*.c; do
        name=$(basename "$source" .c)
        set -- "$@" "$name"
    done
fi
for name in "$@"; do
    echo "$build/tests/unit/$name"
done | xargs -P "$(nproc 2>/dev/null || echo 1)" -I{} "$0" --one {}
