# A study's runs by number of modes and score, and those settings that no other beats with as few modes. Data: block 0
# modes, score of each run; block 1 the front.
eval open(220)
if (!exists('drawn')) drawn = figure.'.'.format
set output drawn
set lmargin at screen left_edge
set rmargin at screen right_edge
set tmargin at screen 0.87
set bmargin at screen 0.155
set xlabel 'modes' offset 0,0.9
set label 100 score_title at screen 0.03, screen 0.5 center rotate by 90
set xrange [0.5:most_modes+0.5]
set xtics most_modes > 12 ? 5 : 1
set yrange [lowest:highest]
set ytics round_tic(highest - lowest, 6)
eval legend(0.99)
set key maxrows 1
plot figure.'.dat' index 0 using 1:2 with points pointtype 7 pointsize dot(0.2) linecolor rgb grey title 'runs', \
     '' index 1 using 1:2 with linespoints linewidth 1.2 pointtype 7 pointsize dot(0.4) linecolor rgb palette[4] title 'front'
