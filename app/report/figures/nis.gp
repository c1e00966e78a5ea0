# NIS of a held-out run by the bank and by the baseline between the 2.5 % and 97.5 % quantiles of chi-square; below it
# the mode probabilities. Data: block 0 time, baseline, bank; block 1 as in estimates.
eval open(270)
if (!exists('drawn')) drawn = figure.'.'.format
set output drawn
set multiplot
set lmargin at screen left_edge
set rmargin at screen right_edge
set xrange [start:end]
set tmargin at screen 0.875
set bmargin at screen 0.48
set format x ''
set logscale y
set format y '1e%T'
set yrange [1e-6:*]
set label 100 'NIS' at screen 0.03, screen 0.68 center rotate by 90
eval legend(0.99)
set object 1 rectangle from graph 0, first lower_bound to graph 1, first upper_bound behind fillcolor rgb accepted_colour fillstyle solid noborder
plot figure.'.dat' index 0 using 1:2 with points pointtype 6 pointsize dot(0.18) linecolor rgb baseline_colour title 'baseline', \
     '' index 0 using 1:3 with points pointtype 7 pointsize dot(0.16) linecolor rgb bank_colour title bank_title, \
     lower_bound with lines linewidth 0.8 dashtype (8,4) linecolor rgb '#000000' title '95 % bounds', \
     upper_bound with lines linewidth 0.8 dashtype (8,4) linecolor rgb '#000000' notitle
unset object 1
load 'strip.gp'
unset multiplot
