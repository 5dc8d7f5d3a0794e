#!/bin/sh
# install.sh BUILD   installs into a folder of its own, then compiles and runs a small program against the installed
# copy as an outsider would: by pkg-config, shared and static; and checks what the shared library exports.
set -eu
build=$1
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
# A make of its own: neither the caller's job server nor the caller's DESTDIR.
unset MAKEFLAGS MAKELEVEL
install_there() {
    make --no-print-directory BUILD="$build" PREFIX="$root/usr" DESTDIR= "$@" >/dev/null
}
install_there install

cat >"$root/outsider.c" <<'END'
#include <photonmap.h>
#include <stdio.h>

int main(void)
{
    pm_photon photons[100];
    for (int i = 0; i < 100; i++) /* a 10 x 10 grid, 1 cm apart, 1 mW each: 10 W/m2 */
        photons[i] = (pm_photon){
            {0.01f * (float)(i % 10), 0.01f * (float)(i / 10), 0}, {0, 0, -1}, {1e-3f, 1e-3f, 1e-3f}};
    pm_map *map = NULL;
    pm_estimator *disc = NULL;
    pm_workspace *workspace = NULL;
    pm_error error = {""};
    pm_status status = pm_map_create(photons, 100, NULL, &map, &error);
    if (status == PM_OK)
        status = pm_estimator_create("disc", &disc, &error);
    if (status == PM_OK)
        status = pm_workspace_create(20, &workspace);
    if (status != PM_OK) {
        fprintf(stderr, "%s\n", *error.text ? error.text : pm_status_text(status));
        return 1;
    }
    pm_query query;
    pm_query_init(&query);
    query.position[0] = query.position[1] = 0.045f;
    query.k = 20;
    const pm_map *const maps[] = {map};
    const pm_source source = {.maps = maps, .map_count = 1, .dimensions = 2};
    pm_estimation estimation;
    status = pm_estimate(disc, &source, &query, workspace, &estimation);
    printf("%zu photons, %.1f W/m2\n", estimation.count, estimation.value[0]);
    pm_workspace_destroy(workspace);
    pm_estimator_destroy(disc);
    pm_map_destroy(map);
    return status != PM_OK || estimation.count != 20 || estimation.value[0] < 8 || estimation.value[0] > 13;
}
END
export PKG_CONFIG_PATH="$root/usr/lib/pkgconfig"
san=
if nm "$build/libphotonmap.a" 2>/dev/null | grep -q __asan_init; then
    san="-fsanitize=address,undefined"
fi
# shellcheck disable=SC2046 # pkg-config answers with several words
${CC:-cc} -std=c11 -Wall -Wextra -Wpedantic $san "$root/outsider.c" $(pkg-config --cflags --libs photonmap) \
    -o "$root/shared"
LD_LIBRARY_PATH="$root/usr/lib" "$root/shared"
# shellcheck disable=SC2046
${CC:-cc} -std=c11 -Wall -Wextra -Wpedantic $san "$root/outsider.c" $(pkg-config --cflags photonmap) \
    "$root/usr/lib/libphotonmap.a" -lm -o "$root/static"
"$root/static"

foreign=$(nm -D --defined-only "$root/usr/lib/libphotonmap.so" | awk '$2 ~ /[TDBR]/ {print $3}' |
    grep -v '^pm_[a-z]' || true)
if [ -z "$san" ] && [ -n "$foreign" ]; then
    echo "install: libphotonmap.so exports: $foreign" >&2
    exit 1
fi
install_there uninstall
left=$(find "$root/usr" -type f -o -type l)
[ -z "$left" ] || { echo "install: uninstall left $left" >&2; exit 1; }
echo "install: an outsider's program runs against the installed library"
