#!/bin/sh
# valgrind.sh BUILD   the unit tests under valgrind's memory checker, where it is installed.
set -eu
if ! command -v valgrind >/dev/null 2>&1; then
    echo "SKIP: valgrind is not installed (apt-get install valgrind)"
    exit 0
fi
for program in "$1"/tests/unit/test_*; do
    case $program in *.d) continue ;; esac
    echo "valgrind $program"
    CK_FORK=no valgrind --quiet --leak-check=full --error-exitcode=9 "$program" >/dev/null
done
