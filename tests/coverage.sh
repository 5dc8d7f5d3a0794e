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
    function report() {
        if (mine && count && (line < lines || branch < branches))
            printf "%-44s lines %6.2f %% of %4d   branches %6.2f %% of %4d\n", file, line, count, branch, of
    }
    /^File / {
        report()
        file = $2
        gsub("\047", "", file)
        mine = file ~ /^(src|estimators)\/.*\.c$/ && !(file in seen)
        seen[file] = 1
        count = of = 0
        branch = 100
    }
    !mine { next }
    { split($0, word, /[:%]/) }
    /^Lines executed/ && !count { line = word[2]; count = $NF; all += count; hit += count * line / 100 } # then: of all
    /^Taken at least once/ { branch = word[2]; of = $NF; every += of; taken += of * branch / 100 }
    END {
        report()
        printf "src/ and estimators/: lines %.1f %% of %d, branches %.1f %% of %d\n",
            100 * hit / all, all, 100 * taken / every, every
    }'
