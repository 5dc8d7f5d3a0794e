#!/bin/sh
# run.sh BUILD   builds the report's page, sees that the committed one is the same, and tests it in headless Chromium.
# As root it installs what is missing from Debian's packages; else it names the line.
set -eu
build=$1
cd "$(dirname "$0")/../.."

missing=
for command in chromium node npm; do
    command -v $command >/dev/null 2>&1 && continue
    [ $command = node ] && package=nodejs || package=$command
    missing="$missing $package"
done
if [ -n "$missing" ]; then
    line="apt-get install -y --no-install-recommends$missing"
    if [ "$(id -u)" != 0 ]; then
        printf 'Missing Debian packages. Install them with:\n    sudo %s\n' "$line" >&2
        exit 1
    fi
    echo "Installing$missing"
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -qq
    $line -qq >/dev/null
fi

page=reports/page
if ! cmp -s $page/package-lock.json $page/node_modules/.installed; then
    (cd $page && npm ci --silent --no-audit --no-fund)
    cp $page/package-lock.json $page/node_modules/.installed
fi
before=$(mktemp)
trap 'rm -f "$before"' EXIT
cp $page/dist/page.html "$before"
(cd $page && npm run --silent build)
if ! cmp -s "$before" $page/dist/page.html; then
    echo "check-report: $page/dist/page.html was not what src/ builds; it is now: commit it" >&2
    exit 1
fi
PM_BUILD=$build node --test --test-reporter=spec tests/page/
