# Error against k: root mean square error and its 95 % interval over trials.
# Drawn by `gnuplot rmse.gp` (SVG), or with -e "format='pdf'; target='rmse.pdf'". The lines above name data and panels.
if (!exists("format")) format = 'svg'
if (!exists("target")) target = 'rmse.' . format
columns = panels < 2 ? 1 : panels < 5 ? 2 : 3
rows = (panels + columns - 1) / columns
if (format eq 'svg') set terminal svg size 480 * columns, 380 * rows dynamic font 'sans-serif,11' background 'white'
if (format eq 'pdf') set terminal pdfcairo size 4.8 * columns, 3.8 * rows font 'sans-serif,9'
set output target
set datafile separator ','
set logscale xy
set autoscale fix
set xtics 4
set ytics 2
set format x '%.2g'
set format y '%.3g'
set key noenhanced font ',8' bmargin center horizontal height 1
set offsets graph 0.05, graph 0.05, graph 0.05, graph 0.05
set grid
set xlabel 'photons in an estimate, k'
set ylabel 'RMSE, % of the mean truth'
set multiplot layout rows, columns
do for [p = 1:panels] {
    set title titles[p] noenhanced
    first = p == 1 ? 0 : last[p - 1] + 1
    plot for [i = first:last[p]] data index i using 1:(100 * $2):(100 * $3):(100 * $4) with yerrorlines \
        linetype style[i + 1] pointsize 0.6 title columnheader(1)
}
unset multiplot
set output
