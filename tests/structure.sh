#!/bin/sh
# The house's structure, checked: includes point downwards only, every file of a list has its row, the library needs
# nothing but C and libm, and neither files nor lines grow out of hand.
set -eu
status=0
fail() {
    echo "structure: $*" >&2
    status=1
}

# A folder may include what stands before it here, and itself.
layers="src/base src/map src/search estimators src/lookup src/stats src/scene src/transport src/image src/metrics"
layers="$layers cases src/methods src/accuracy src/converge src/storage src/stress src/report bench src/cli tests"
rank() {
    n=0
    for layer in $layers; do
        n=$((n + 1))
        case $1 in "$layer"/*) echo $n && return ;; esac
    done
    echo 0 # src/photonmap.h: below everything
}

for file in $(find src estimators cases tests -name '*.[ch]' | sort); do
    mine=$(rank "$file")
    dir=$(dirname "$file")
    # shellcheck disable=SC2013 # neither names nor paths hold spaces
    for include in $(sed -n 's/^#include "\(.*\)"/\1/p' "$file"); do
        path=$(realpath -m --relative-to=. "$dir/$include")
        [ -f "$path" ] || fail "$file includes $include, which is not there"
        [ "$(rank "$path")" -le "$mine" ] || fail "$file includes $path, which is above it"
    done
    lines=$(wc -l <"$file")
    [ "$lines" -le 500 ] || fail "$file has $lines lines; 400 is the house's size"
done

long=$(find src estimators cases bench tests Makefile -name '*.[ch]' -o -name '*.cc' -o -name '*.sh' -o -name Makefile |
    LC_ALL=C.UTF-8 xargs grep -nE '^.{121}' || true)
[ -z "$long" ] || fail "lines of more than 120 columns:
$long"

# Every source of a list is a row, or is named beside the rows in the list's comment.
for dir in src/search estimators cases cases/scenes src/methods/progressive src/transport/policies src/stress \
    src/metrics; do
    for file in "$dir"/*.c; do
        name=$(basename "$file" .c)
        row=$(echo "$name" | tr - _)
        grep -q "X($row)" $dir/list.h || grep -q "\b$name\.c\b" $dir/list.h || fail "$file has no row in $dir/list.h"
    done
    # shellcheck disable=SC2013
    for row in $(sed -n 's/^ *X(\([a-z_0-9]*\)).*/\1/p' $dir/list.h); do
        [ -f "$dir/$row.c" ] || [ -f "$dir/$(echo "$row" | tr _ -).c" ] || fail "$dir/list.h: no file for $row"
    done
done

# Stored references: a pair of files for each row, a row for each pair.
references=cases/scenes/references
for row in $(sed -n 's/^ *X(\([a-z_0-9]*\)).*/\1/p' src/image/references.h); do
    [ -f "$references/$row.exr" ] && [ -f "$references/$row.error.exr" ] ||
        fail "src/image/references.h: no pair of files for $row in $references"
done
for file in "$references"/*.exr; do
    [ -f "$file" ] || continue
    row=$(basename "${file%.exr}" .error)
    grep -q "^ *X($row)" src/image/references.h || fail "$file has no row in src/image/references.h"
done

# The library prints nothing, exits nowhere, starts no threads.
if grep -nE '\b(printf|puts|putchar|perror|exit|abort|pthread_create)\(|\bstd(out|err)\b|#pragma omp' \
    src/base/*.c src/map/*.c src/search/*.c src/lookup/*.c estimators/*.c; then
    fail "the library prints, exits or starts threads"
fi

# Files read alike whatever the locale of the program that links the library: no locale with a decimal comma need be
# installed here to try it, so the call is looked for.
if grep -nE '\b(strtod|strtof|atof|scanf)\(' src/map/*.c src/search/*.c src/lookup/*.c estimators/*.c; then
    fail "a number is read in the caller's locale: strtod_l takes one of its own"
fi
[ $status = 0 ] && echo "structure: includes, lists and sizes hold"
exit $status
