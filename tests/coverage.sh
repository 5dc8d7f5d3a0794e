#!/bin/sh
# coverage.sh BUILD [KIND...]   runs the tests of a build made with --coverage, and prints what they reach: lines and
# branches of each file of src/ and estimators/ that has less than 90 or 80 %, and of all. No other tool than gcov.
set -eu
build=$1
shift
[ $# -gt 0 ] || set -- errata oracle unit faults cli fuzz
find "$build" -name '*.gcda' -delete
CK_TIMEOUT_MULTIPLIER=5 tests/run.sh "$build" "$@" | tail -n 1
for kind in src estimators; do
    find "$build/obj/$kind" -name '*.gcno' | sort
done | xargs gcov --branch-probabilities --no-output 2>/dev/null | awk -v lines=90 -v branches=80 '
    /^File / {
        file = $2
        gsub("\047", "", file)
        mine = file ~ /^(src|estimators)\/.*\.c$/ && !(file in seen)
        seen[file] = 1
    }
    /^$/ { mine = 0 } # a sum of all follows the last file
    !mine { next }
    { split($2, part, /[:%]/) }
    /^Lines executed/ { line = part[2]; count = $4; all += count; hit += count * line / 100 }
    /^Taken at least once/ {
        split($0, word, /[:%]/)
        branch = word[2]; of = $NF; every += of; taken += of * branch / 100
        if (line < lines || branch < branches)
            printf "%-44s lines %6.2f %% of %4d   branches %6.2f %% of %4d\n", file, line, count, branch, of
    }
    END {
        printf "src/ and estimators/: lines %.1f %% of %d, branches %.1f %% of %d\n",
            100 * hit / all, all, 100 * taken / every, every
    }'
