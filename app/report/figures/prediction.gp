# A held-out run: inputs, and one state with the bank's one-step 95 % band, samples outside it marked.
# Data: block 0 time, measured, lower, upper, outside (NaN: inside); block 1 time, then the inputs.
eval open(270)
if (!exists('drawn')) drawn = figure.'.'.format
set output drawn
stats figure.'.dat' index 1 using 2 nooutput
lowest = STATS_min
highest = STATS_max
do for [j = 2:inputs] {
  stats figure.'.dat' index 1 using j+1 nooutput
  lowest = STATS_min < lowest ? STATS_min : lowest
  highest = STATS_max > highest ? STATS_max : highest
}
input_range = highest > lowest ? highest - lowest : 1
set multiplot
array input_colour[4] = ['#000000', '#E69F00', '#56B4E9', '#009E73']
set lmargin at screen left_edge
set rmargin at screen right_edge
set xrange [start:end]
set tmargin at screen 0.93
set bmargin at screen 0.66
set format x ''
set label 100 input_label at screen 0.03, screen 0.795 center rotate by 90
set ytics round_tic(input_range, 4)
eval legend(0.99)
set key maxrows 1
set yrange [lowest-0.05*input_range:highest+0.05*input_range]
plot for [j = 1:inputs] figure.'.dat' index 1 using 1:j+1 with steps linewidth 0.8 linecolor rgb input_colour[(j-1) % 4 + 1] title input_title[j]
eval legend(0.615)
set tmargin at screen 0.49
set bmargin at screen 0.125
set format x '% h'
set xlabel 'time [s]' offset 0,0.9
set label 100 state_label at screen 0.03, screen 0.31 center rotate by 90
set ytics autofreq
set yrange [*:*]
plot figure.'.dat' index 0 using 1:3:4 with filledcurves linecolor rgb band_colour title '95 % band', \
     '' index 0 using 1:2 with lines linewidth 0.8 linecolor rgb '#000000' title 'measured', \
     '' index 0 using 1:5 with points pointtype 7 pointsize dot(0.2) linecolor rgb outlier_colour title outside_title
unset multiplot
