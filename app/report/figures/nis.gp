# NIS of a held-out run by the bank and by the baseline between the 2.5 % and 97.5 % quantiles of chi-square; below it
# the mode probabilities. Data: block 0 time, baseline, bank; block 1 as in estimates.
eval open(270)
set output figure.'.'.format
set multiplot
set lmargin at screen 0.15
set rmargin at screen 0.985
set xrange [start:end]
set tmargin at screen 0.93
set bmargin at screen 0.47
set format x ''
set logscale y
set format y '10^{%T}' 
set format y '%.0e'
set yrange [1e-6:*]
set ylabel 'NIS' offset 1.6,0
set key above left Left reverse horizontal
set object 1 rectangle from graph 0, first lower_bound to graph 1, first upper_bound behind fillcolor rgb '#e6e6e6' fillstyle solid noborder
plot figure.'.dat' index 0 using 1:2 with points pointtype 6 pointsize 0.18 linecolor rgb mode_colour(0) title 'one Kalman filter', \
     '' index 0 using 1:3 with points pointtype 7 pointsize 0.16 linecolor rgb mode_colour(1) title bank_title, \
     lower_bound with lines linewidth 0.8 dashtype (4,2) linecolor rgb '#000000' title '95 % bounds', \
     upper_bound with lines linewidth 0.8 dashtype (4,2) linecolor rgb '#000000' notitle
unset object 1
load 'strip.gp'
unset multiplot
