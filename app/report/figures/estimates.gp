# One state of a held-out run: measured, predicted by the baseline and by the bank; below it the mode probabilities.
# Data: block 0 time, measured, baseline, bank; block 1 time, then the probabilities' running sums from 0 to 1.
eval open(270)
set output figure.'.'.format
set multiplot
set lmargin at screen 0.13
set rmargin at screen 0.985
set xrange [start:end]
set tmargin at screen 0.93
set bmargin at screen 0.47
set format x ''
set ylabel state_label offset 1.6,0
set key above left Left reverse horizontal
plot figure.'.dat' index 0 using 1:2 with lines linewidth 1.6 linecolor rgb '#000000' title 'measured', \
     '' index 0 using 1:3 with lines linewidth 0.9 dashtype (4,2) linecolor rgb mode_colour(0) title 'one Kalman filter', \
     '' index 0 using 1:4 with lines linewidth 0.9 linecolor rgb mode_colour(1) title bank_title
load 'strip.gp'
unset multiplot
