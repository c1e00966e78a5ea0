# One state of a held-out run: measured, predicted by the baseline and by the bank with its band; below it the mode probabilities.
# Data: block 0 time, measured, baseline, bank, the bank's 95 % band from, to; block 1 time, then the probabilities' running sums from 0 to 1.
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
set label 100 state_label at screen 0.03, screen 0.68 center rotate by 90
eval legend(0.99)
plot figure.'.dat' index 0 using 1:5:6 with filledcurves linecolor rgb band_colour title '95 % band', \
     '' index 0 using 1:2 with lines linewidth 1.4 linecolor rgb '#000000' title 'measured', \
     '' index 0 using 1:3 with lines linewidth 0.8 linecolor rgb baseline_colour title 'baseline', \
     '' index 0 using 1:4 with lines linewidth 0.8 linecolor rgb bank_colour title bank_title
load 'strip.gp'
unset multiplot
