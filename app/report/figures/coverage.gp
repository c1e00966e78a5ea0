# Share of samples whose NIS lies outside the 95 % interval, above (upwards) and below (downwards), training and held-out
# runs, by filter. Data: a row per filter: position, train above, train below, test above, test below [%].
eval open(220)
set output figure.'.'.format
set lmargin at screen 0.13
set rmargin at screen 0.985
set tmargin at screen 0.88
set bmargin at screen 0.16
set xrange [0.4:filters+0.6]
set yrange [*:*]
set ytics format '%g'
set ylabel 'outside [%]: below | above' offset 1.6,0
set xtics scale 0
do for [f = 1:filters] { set xtics add (filter_title[f] f) }
set key above left Left reverse horizontal samplen 0.8
set boxwidth 0.34
set xzeroaxis linetype -1 linewidth 0.6
plot figure.'.dat' index 0 using ($1-0.19):2 with boxes linecolor rgb mode_colour(0) title 'training runs', \
     '' index 0 using ($1-0.19):(-$3) with boxes linecolor rgb mode_colour(0) notitle, \
     '' index 0 using ($1+0.19):4 with boxes linecolor rgb mode_colour(1) title 'held-out runs', \
     '' index 0 using ($1+0.19):(-$5) with boxes linecolor rgb mode_colour(1) notitle, \
     2.5 with lines linewidth 0.8 dashtype (4,2) linecolor rgb '#000000' title '2.5 % of a true filter', \
     -2.5 with lines linewidth 0.8 dashtype (4,2) linecolor rgb '#000000' notitle
