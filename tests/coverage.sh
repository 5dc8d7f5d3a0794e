#!/bin/sh
# coverage.sh BUILD [KIND...]   runs the tests of a build made with --coverage (-O0), and prints what they reach: lines
# and branches of each file of src/ and estimators/ that has less than 90 or 80 %, and of all. Fails where all have
# less. No other tool than gcov, which counts as a branch each way out of a condition: `if (a && b)` has four. What
# several objects compile (headers, and the kernels of each SIMD width there) counts once, as reached where one was.
set -eu
build=$1
shift
[ $# -gt 0 ] || set -- errata oracle unit faults cli fuzz
find "$build" -name '*.gcda' -delete
status=0
CK_TIMEOUT_MULTIPLIER=5 tests/run.sh "$build" "$@" >"$build/coverage.log" 2>&1 || status=$?
tail -n 1 "$build/coverage.log"
[ "$status" = 0 ] || { cat "$build/coverage.log" && exit "$status"; }
for kind in src estimators cases; do # what cases/ compile of headers of src/
    find "$build/obj/$kind" -name '*.gcno' | sort
done | xargs gcov --branch-probabilities --branch-counts --stdout 2>/dev/null | awk -v lines=90 -v branches=80 '
    function percent(part, whole) { return whole ? 100 * part / whole : 100 }
    /^ *-: +0:Source:/ {
        file = substr($0, index($0, "Source:") + 7)
        mine = file ~ /^(src|estimators)\/.*\.[ch]$/
    }
    !mine { next }
    /^branch/ {
        key = file SUBSEP line SUBSEP nth++
        if (!(key in taken)) {
            of[file]++
            taken[key] = 0
        }
        if ($3 == "taken" && $4 > 0 && !taken[key]) {
            took[file]++
            taken[key] = 1
        }
    }
    /^ *([0-9]+\*?|#####|=====): *[0-9]+:/ {
        split($0, word, ":")
        line = word[2] + 0
        nth = 0
        key = file SUBSEP line
        if (!(key in reached)) {
            if (!count[file]++)
                files[++many] = file
            reached[key] = 0
        }
        if (word[1] ~ /[0-9]/ && !reached[key]) {
            hit[file]++
            reached[key] = 1
        }
    }
    END {
        for (i = 1; i <= many; i++) {
            file = files[i]
            l = percent(hit[file], count[file])
            b = percent(took[file], of[file])
            if (l < lines || b < branches)
                printf "%-44s lines %6.2f %% of %4d   branches %6.2f %% of %4d\n", file, l, count[file], b, of[file]
            all += count[file]
            all_hit += hit[file]
            every += of[file]
            all_took += took[file]
        }
        l = percent(all_hit, all)
        b = percent(all_took, every)
        printf "src/ and estimators/: lines %.1f %% of %d, branches %.1f %% of %d\n", l, all, b, every
        if (!all || l < lines || b < branches) {
            printf "coverage: below %d %% of lines or %d %% of branches\n", lines, branches
            exit 1
        }
    }'
