# A held-out run: inputs, and one state with the bank's one-step 95 % band, samples outside it marked.
# Data: block 0 time, measured, lower, upper, outside (NaN: inside); block 1 time, then the inputs.
eval open(250)
set output figure.'.'.format
set multiplot
set lmargin at screen 0.13
set rmargin at screen 0.985
set xrange [start:end]
set tmargin at screen 0.92
set bmargin at screen 0.63
set format x ''
set ylabel input_label offset 1.6,0
set ytics maxrev 4
set key above left Left reverse horizontal
plot for [j = 1:inputs] figure.'.dat' index 1 using 1:j+1 with steps linewidth 0.8 linecolor rgb mode_colour(j-1) title input_title[j]
set tmargin at screen 0.50
set bmargin at screen 0.15
set format x '% h'
set xlabel 'time [s]' offset 0,0.9
set ylabel state_label offset 1.6,0
plot figure.'.dat' index 0 using 1:3:4 with filledcurves linecolor rgb band_colour title '95 % band', \
     '' index 0 using 1:2 with lines linewidth 0.8 linecolor rgb '#000000' title 'measured', \
     '' index 0 using 1:5 with points pointtype 7 pointsize 0.2 linecolor rgb '#D55E00' title outside_title
unset multiplot
