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
# Whose colour is whose, in the gap above the strip.
if (layers > 1) {
  set label 101 'mode' at screen left_edge, screen 0.446 left font legend_font
  key_step = (right_edge - left_edge - 0.21) / layers
  if (key_step > 0.08) { key_step = 0.08 }
  do for [k = 1:layers] {
    key_x = left_edge + 0.09 + (k - 1) * key_step
    set object 200+k rectangle from screen key_x, screen 0.434 to screen key_x+0.016, screen 0.458 fillcolor rgb layer_colour(k) fillstyle solid noborder
    set label 200+k layer_title[k] at screen key_x+0.02, screen 0.446 left font legend_font
  }
}
plot for [k = 1:layers] figure.'.dat' index 1 using 1:(column(k+1)):(column(k+2)) with filledcurves linecolor rgb layer_colour(k) notitle
