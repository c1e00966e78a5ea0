# Mode probabilities as a strip over time, in the lower part of a figure.
set tmargin at screen 0.41
set bmargin at screen 0.125
set format x '% h'
set format y '% h'
unset logscale y
unset arrow
set xlabel 'time [s]' offset 0,0.9
set label 100 'P(mode)' at screen 0.03, screen 0.27 center rotate by 90
set yrange [0:1]
set ytics 0,0.5,1
unset key
plot for [k = 0:K-1] figure.'.dat' index 1 using 1:(column(k+2)):(column(k+3)) with filledcurves linecolor rgb palette[k+1] notitle
