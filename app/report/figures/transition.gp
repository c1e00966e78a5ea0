# The modes as nodes, their switches as arrows as wide as they are probable. Data: per arrow a block of its line, then per
# arrow a block of its head.
eval open(300)
if (!exists('drawn')) drawn = figure.'.'.format
set output drawn
set lmargin at screen 0.02
set rmargin at screen 0.98
set tmargin at screen 0.98
set bmargin at screen 0.02
unset border
unset tics
unset key
set size ratio -1
set xrange [-1.3:1.3]
set yrange [-1.2:1.2]
do for [k = 1:nodes] {
  set object k circle at real(node_x[k]), real(node_y[k]) size real(node_radius[k]) front fillcolor rgb palette[k] fillstyle solid border rgb '#444444' linewidth 0.6
  set label k node_title[k] at real(node_x[k]), real(node_y[k]) center front textcolor rgb node_ink[k]
}
do for [e = 1:edges] {
  if (edge_title[e] ne '') { set label 100+e edge_title[e] at real(edge_x[e]), real(edge_y[e]) center front font legend_font }
}
plot for [e = 1:edges] figure.'.dat' index e-1 using 1:2 with lines linewidth real(edge_width[e]) linecolor rgb edge_colour[e], \
     for [e = 1:edges] '' index edges+e-1 using 1:2 with filledcurves closed linecolor rgb edge_colour[e], NaN
