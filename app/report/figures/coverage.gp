# Share of samples whose NIS lies outside the 95 % interval, above (upwards) and below (downwards), training and held-out
# runs, by filter. Data: a row per filter: position, train above, train below, test above, test below [%].
eval open(220)
if (!exists('drawn')) drawn = figure.'.'.format
set output drawn
set lmargin at screen left_edge
set rmargin at screen right_edge
set tmargin at screen 0.85
set bmargin at screen filters > 4 ? 0.25 : 0.11
set xrange [0.4:filters+0.6]
larger(a, b) = a == a && (b != b || a > b) ? a : b  # of two of which one may be NaN
stats figure.'.dat' index 0 using (larger(column(2), column(4))) nooutput
highest = STATS_max > 2.5 ? STATS_max : 2.5
stats figure.'.dat' index 0 using (larger(column(3), column(5))) nooutput
lowest = STATS_max > 2.5 ? STATS_max : 2.5
step = round_tic(highest + lowest, 8)
set yrange [-1.05*lowest:1.05*highest]
set ytics ('0' 0)
do for [i = 1:10] { set ytics add (sprintf('%g', i * step) i * step, sprintf('%g', i * step) -i * step) }
set label 100 'NIS below | above [%]' at screen 0.03, screen 0.5 center rotate by 90
if (filters > 4) { set xtics scale 0 rotate by 35 right offset 0.6,0.2 } else { set xtics scale 0 }
set xtics (filter_title[1] 1)
do for [f = 2:filters] { set xtics add (filter_title[f] f) }
eval legend(0.99)
set boxwidth 0.34
set xzeroaxis linetype -1 linewidth 0.6
plot figure.'.dat' index 0 using ($1-0.19):2 with boxes linecolor rgb palette[1] title 'training', \
     '' index 0 using ($1-0.19):(-$3) with boxes linecolor rgb palette[1] notitle, \
     '' index 0 using ($1+0.19):4 with boxes linecolor rgb palette[2] title 'held out', \
     '' index 0 using ($1+0.19):(-$5) with boxes linecolor rgb palette[2] notitle, \
     2.5 with lines linewidth 0.8 dashtype (8,4) linecolor rgb '#000000' title 'true filter: 2.5 %', \
     -2.5 with lines linewidth 0.8 dashtype (8,4) linecolor rgb '#000000' notitle
