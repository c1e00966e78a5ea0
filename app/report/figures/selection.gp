# Criteria over the number of components; lower is better on the left axis, higher for the held-out score on the right.
# Data: block 0 components, BIC, ICL, AIC, held-out score, share of restarts that agree; block 1 the chosen row.
eval open(230)
if (!exists('drawn')) drawn = figure.'.'.format
set output drawn
set lmargin at screen 0.16
set rmargin at screen 0.85
set tmargin at screen 0.85
set bmargin at screen 0.15
set border heldout ? 11 : 3
set xlabel 'components K' offset 0,0.9
set label 100 'BIC, ICL, AIC' at screen 0.03, screen 0.5 center rotate by 90
if (heldout) { set y2label 'held out [nats/window]' offset -1.6,0; set y2tics offset -0.4,0 }
set xrange [first-0.4:last+0.4]
tick = (last - first) > 12 ? 5 : 1
set xtics tick
left_edge = 0.1
eval legend(0.99)
set arrow 1 from chosen, graph 0 to chosen, graph 1 nohead back linewidth 5 linecolor rgb accepted_colour
if (!heldout) { set y2range [0:1] }  # an axis without any point is an error
plot figure.'.dat' index 0 using 1:2 with linespoints pointtype 7 pointsize dot(0.3) linewidth 1 linecolor rgb palette[1] title 'BIC', \
     '' index 0 using 1:3 with linespoints pointtype 5 pointsize dot(0.3) linewidth 1 linecolor rgb palette[2] title 'ICL', \
     '' index 0 using 1:4 with linespoints pointtype 9 pointsize dot(0.3) linewidth 1 linecolor rgb palette[3] title 'AIC', \
     '' index 0 using 1:(heldout ? $5 : NaN) axes x1y2 with linespoints pointtype 13 pointsize dot(0.3) linewidth 1 dashtype (8,4) linecolor rgb palette[4] title (heldout ? 'held out' : ''), \
     1/0 with lines linewidth 5 linecolor rgb accepted_colour title 'chosen'
