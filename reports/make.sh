#!/bin/sh
# make.sh BUILD   runs what a whole report needs and makes the page: BUILD/report/index.html. At most two hours on two
# cores; REPORT_PROFILE=quick a few minutes, into BUILD/report-quick. Each part is a file of parts/, made if it is not
# there: what was stopped goes on where it was. Remove a part, or the folder, to measure it again.
set -eu
build=$1
profile=${REPORT_PROFILE:-full}
case $profile in
full) out=$build/report ;;
quick) out=$build/report-quick ;;
*) echo "report: REPORT_PROFILE is full or quick, not '$profile'" >&2 && exit 2 ;;
esac
bench=$build/photonbench
parts=$out/parts
mkdir -p "$parts"

# part NAME MINUTES COMMAND...   states a part in the plan, or makes it. MINUTES: expected, on two cores.
part() {
    name=$1
    minutes=$2
    shift 2
    file=$parts/$name.json
    if [ "$doing" = plan ]; then
        state=$minutes
        [ ! -f "$file" ] || state=there
        printf '  %-20s %6s  %s\n' "$name" "$state" "$*" | cut -c 1-118
        [ -f "$file" ] || total=$((total + minutes))
        return
    fi
    [ ! -f "$file" ] || return 0
    printf 'report: %s, about %s min\n' "$name" "$minutes"
    # What is interrupted writes what it has: only what ended counts. Status 1: a check failed, which the page shows.
    status=0
    "$bench" "$@" --quiet --json "$file.unfinished" >/dev/null || status=$?
    if [ $status -gt 1 ]; then
        rm -f "$file.unfinished"
        echo "report: $name stopped with status $status; make report goes on from here" >&2
        exit $status
    fi
    mv "$file.unfinished" "$file"
}

# image SCENE SIZE MINUTES   images by all estimators and the truth, at a size at which there is one.
image() {
    part "images-$1" "$3" render "$1" --estimator "$estimators" --size "$2" --spp "$spp" --aov --trials 2 --half \
        -o "$parts/images.exr"
}

full_parts() {
    estimators=all
    spp=64
    part accuracy 22 accuracy --profile full
    part accuracy-scenes 9 accuracy --case scene:glass-sphere,scene:nephroid,scene:water,scene:plate --trials 200 \
        --k 15,50,200
    part search 8 search --case box,square,caustic,volume --k 8,50,500 --search all --threads 1 --seconds 400
    part search-grows 6 search --case box --k 50 --photons 10000,100000,1000000,10000000 --threads 1 --seconds 200
    part storage 24 storage --profile full --seconds 210
    part converge 11 converge plate --method all --profile full --seconds 60
    part converge-alpha 13 converge water glass-sphere --method ppm,sppm,pppm --alpha 0.5,0.667,0.8 --profile full \
        --seconds 30
    part stress 5 stress --profile full
    image cornell 128x128 1
    image glass-sphere 256x256 1
    image nephroid 256x256 1
    image cognac 128x128 1
    image four-lights 128x128 1
    image corner 256x256 1
}

quick_parts() {
    estimators=disc,hull,gaussian
    spp=4
    part accuracy 1 accuracy --case square,edge,corner --trials 16 --probes 256
    part search 1 search --photons 100000 --k 8,50 --seconds 10
    part storage 1 storage egg --photons 20000,80000 --trials 3 --paths 10000 --spp 8 --seconds 20
    part converge 1 converge plate --method ppm,sppm,pppm --passes 64 --trials 4 --size 16x16 --seconds 5
    part stress 1 stress --test single,duplicates,ties,powers
    image cornell 128x128 0
    image glass-sphere 256x256 0
}

doing=plan
total=0
echo "report: the plan ($profile; minutes on two cores):"
"${profile}_parts"
echo "report: about $total min to go, then the page: $out/index.html"
doing=work
"${profile}_parts"

# The images of each scene and its truth, which is the same for each estimator; the page computes errors.
set --
for file in "$parts"/*.json; do
    case $file in */images-*) ;; *) set -- "$@" "$file" ;; esac
done
for file in "$parts"/images.*.exr; do
    case $file in
    *.error.exr | *.bias.exr | *.noise.exr | *.radius.exr | *.count.exr) ;;
    *) set -- "$@" "$file" ;;
    esac
done
"$bench" report "$@" -o "$out" --figures "$out/figures"
ls -l "$out/index.html"
