#!/bin/sh
# bias.sh [PHOTONBENCH]   measures bias.csv and draws bias.svg, both beside this script. Needs gnuplot. About a minute
# on two cores. With DRAW=only the numbers stay and the figure alone is drawn again.
set -eu
bench=${1:-build/photonbench}
folder=$(dirname "$0")

if [ "${DRAW:-}" != only ]; then
    rows=$(mktemp)
    trap 'rm -f "$rows"' EXIT
    "$bench" accuracy --case square --sampler poisson --photons 40000 --trials 400 \
        --k 5,7,10,15,25,35,50,75,100,150,200,350,500 \
        --estimator disc,disc:last=none,gaussian:form=printed,hull:boundary=0 \
        --quiet --csv "$rows" >/dev/null
    # The columns that are drawn, in %; commas inside quotes become semicolons.
    awk -F'"' -v OFS= '{ for (i = 2; i <= NF; i += 2) gsub(",", ";", $i) } 1' "$rows" |
        awk -F, '
            NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i
                      print "region,estimator,k,bias,low,high,predicted"; next }
            $column["region"] ~ /interior|edge/ {
                printf "%s,%s,%s", $column["region"], $column["estimator"], $column["k"]
                printf ",%.4f,%.4f,%.4f,%.4f\n", 100 * $column["rel_bias"], 100 * $column["rel_bias_ci95_low"],
                    100 * $column["rel_bias_ci95_high"], 100 * $column["predicted_rel_bias"] }' >"$folder/bias.csv"
fi
gnuplot -e "folder='$folder'" "$folder/bias.gp"
