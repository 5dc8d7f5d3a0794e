# Draws bias.svg from bias.csv; bias.sh calls it. Above: bias, measured (points) and predicted (lines). Below: what is
# left between the two, with 95 % intervals of the measurement.
csv = folder . '/bias.csv'
set encoding utf8
set terminal svg size 960,560 dynamic font 'Helvetica,Arial,sans-serif,14' background '#ffffff'
set output folder . '/bias.svg'
set datafile separator ','

names = 'disc:last=full disc:last=none gaussian:form=printed;last=full hull:boundary=0;outside=keep'
colours = '#d55e00 #0072b2 #777777 #009e73'
marks = '5 7 9 13'
order = '3 1 2 4' # what is drawn last is on top
mine(panel, i) = strcol(1) eq panel && strcol(2) eq word(names, i)
keep(panel, i, y) = mine(panel, i) ? column(y) : NaN
rest(panel, i, y) = mine(panel, i) ? column(y) - column(7) : NaN
beside(i) = column(3) * 1.04 ** (int(i) - 2.5)

set logscale x
set xrange [4.4:570]
set border 3 linecolor '#888888'
set tics scale 0.5
set grid ytics linecolor '#e0e0e0' linewidth 1 dashtype solid
unset key
set multiplot

do for [p = 1:2] {
    panel = p == 1 ? 'interior' : 'edge'
    left = p == 1 ? 0.110 : 0.590
    set lmargin at screen left
    set rmargin at screen left + 0.395

    set tmargin at screen 0.92
    set bmargin at screen 0.38
    set yrange [-68:32]
    set xtics (5, 10, 20, 50, 100, 200, 500) nomirror format ''
    set ytics ('+20 %%' 20, '0' 0, '−20 %%' -20, '−40 %%' -40, '−60 %%' -60) nomirror textcolor rgb '#333333'
    unset xlabel
    set title (p == 1 ? 'Far from every edge' : 'Within 0.05 m of an edge') textcolor rgb '#111111' \
        font ',16' offset 0,-0.4
    if (p == 1) { set ylabel 'bias' textcolor rgb '#333333' offset 0.5,0 } \
    else { unset ylabel }
    set arrow 1 from 4.4,0 to 570,0 nohead linecolor rgb '#666666' linewidth 1 back
    if (p == 1) {
        set label 1 'disc as printed: 1/(k-1)' at 6.2,23.5 textcolor rgb word(colours, 1)
        set label 2 'Gaussian as printed' at 12,-38.5 textcolor rgb word(colours, 3)
        set label 3 'disc:last=none and hull:boundary=0' at 8,-6 textcolor rgb '#333333'
    } else {
        set label 1 'disc as printed' at 6.4,21 textcolor rgb word(colours, 1)
        set label 2 'Gaussian as printed' at 12,-40 textcolor rgb word(colours, 3)
        set label 3 'disc:last=none' at 5.2,-8 textcolor rgb word(colours, 2)
        set label 4 'hull:boundary=0' at 70,6 textcolor rgb word(colours, 4)
    }
    plot for [i in order] csv skip 1 using 3:(keep(panel, int(i), 7)) with lines linewidth 1.8 \
             linecolor rgb word(colours, int(i)), \
         for [i in order] csv skip 1 using 3:(keep(panel, int(i), 4)) with points pointsize 0.6 \
             pointtype int(word(marks, int(i))) linecolor rgb word(colours, int(i))

    unset label 1
    unset label 2
    unset label 3
    unset label 4
    unset title
    set tmargin at screen 0.33
    set bmargin at screen 0.125
    set yrange [-0.7:0.7]
    set xtics (5, 10, 20, 50, 100, 200, 500) nomirror textcolor rgb '#333333' format '%g'
    set ytics ('+0.5 %%' 0.5, '0' 0, '−0.5 %%' -0.5) nomirror
    set xlabel 'photons in an estimate, k' textcolor rgb '#333333' offset 0,0.3
    if (p == 1) { set ylabel 'measured − predicted' textcolor rgb '#333333' offset 0.5,0 }
    # Side by side, by 4 % of k.
    plot for [i in order] csv skip 1 using (beside(i)):(rest(panel, int(i), 5)):(0):(rest(panel, int(i), 6) - \
             rest(panel, int(i), 5)) with vectors nohead linewidth 1.3 linecolor rgb word(colours, int(i)), \
         for [i in order] csv skip 1 using (beside(i)):(rest(panel, int(i), 4)) with points pointsize 0.4 \
             pointtype int(word(marks, int(i))) linecolor rgb word(colours, int(i))
}
unset multiplot
