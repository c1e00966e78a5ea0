# Criteria over the number of components; lower is better on the left axis, higher for the held-out score on the right.
# Data: block 0 components, BIC, ICL, AIC, held-out score, share of restarts that agree; block 1 the chosen row.
eval open(230)
set output figure.'.'.format
set lmargin at screen 0.16
set rmargin at screen 0.85
set tmargin at screen 0.90
set bmargin at screen 0.15
set border 11
set xlabel 'components K' offset 0,0.9
set ylabel 'BIC, ICL, AIC' offset 1.6,0
set y2label 'held out [nats/window]' offset -1.6,0
set y2tics offset -0.4,0
set xrange [first-0.4:last+0.4]
set xtics (last - first) > 12 ? 5 : 1
set key above left Left reverse horizontal samplen 1.4
set arrow 1 from chosen, graph 0 to chosen, graph 1 nohead back linewidth 5 linecolor rgb '#e6e6e6'
plot figure.'.dat' index 0 using 1:2 with linespoints pointtype 7 pointsize 0.35 linewidth 1 linecolor rgb mode_colour(0) title 'BIC', \
     '' index 0 using 1:3 with linespoints pointtype 5 pointsize 0.3 linewidth 1 linecolor rgb mode_colour(1) title 'ICL', \
     '' index 0 using 1:4 with linespoints pointtype 9 pointsize 0.4 linewidth 1 linecolor rgb mode_colour(2) title 'AIC', \
     '' index 0 using 1:5 axes x1y2 with linespoints pointtype 13 pointsize 0.45 linewidth 1 dashtype (4,2) linecolor rgb mode_colour(3) title 'held out', \
     1/0 with lines linewidth 5 linecolor rgb '#e6e6e6' title 'chosen'
