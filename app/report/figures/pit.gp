# Histogram of the probability integral transform on held-out runs: flat when the stated uncertainty is true.
# Data: per filter a block of bin centre, density.
eval open(200)
if (!exists('drawn')) drawn = figure.'.'.format
set output drawn
set lmargin at screen left_edge
set rmargin at screen right_edge
set tmargin at screen 0.8
set bmargin at screen 0.17
set xrange [0:1]
set yrange [0:*]
set xlabel 'PIT of the one-step prediction' offset 0,0.9
set label 100 'density' at screen 0.03, screen 0.5 center rotate by 90
eval legend(0.99)
set key maxrows 3
set object 1 rectangle from graph 0, first uniform_low to graph 1, first uniform_high behind fillcolor rgb accepted_colour fillstyle solid noborder
plot for [f = 1:filters] figure.'.dat' index f-1 using 1:2 with histeps linewidth 1.1 linecolor rgb filter_colour[f] title filter_title[f], \
     1/0 with lines linewidth 5 linecolor rgb accepted_colour title '95 % if uniform'
