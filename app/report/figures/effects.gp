# What each varied key of a study does to a score: the best of the settings with a value, whatever the other keys, and the
# mean of their runs. Data: per key a block of position, best, mean, and a block of position, score of each run.
columns = panels > 1 ? 2 : 1
lines = (panels + columns - 1) / columns
eval open(40 + 150 * lines)
if (!exists('drawn')) drawn = figure.'.'.format
set output drawn
set multiplot
height = 1.0 - 30.0 / (40 + 150 * lines)
set yrange [lowest:highest]
set ytics round_tic(highest - lowest, 6)
do for [p = 1:panels] {
  column_left = 0.15 + ((p - 1) % columns) * 0.45
  line_top = height * (1.0 - ((p - 1) / columns) / real(lines))
  set lmargin at screen column_left
  set rmargin at screen (columns == 1 ? right_edge : column_left + 0.375)
  set tmargin at screen line_top - 0.03 / lines
  set bmargin at screen line_top - 0.72 * height / lines
  set xrange [0.5:int(level_count[p])+0.5]
  set xlabel key_title[p] offset 0,0.7
  set xtics scale 0.4 offset 0,0.4 (word(level_titles[p], 1) 1)
  every = int(level_count[p]) > 7 ? 2 : 1
  if (int(level_count[p]) > every) { do for [l = 1+every:int(level_count[p]):every] { set xtics add (word(level_titles[p], l) l) } }
  if ((p - 1) % columns == 0) { set format y '% h'; set label 100 score_title at screen 0.03, screen line_top-0.37*height/lines center rotate by 90 } else { set format y ''; unset label 100 }
  if (p == 1) { eval legend(0.99) } else { unset key }
  plot figure.'.dat' index 2*p-1 using 1:2 with points pointtype 7 pointsize dot(0.12) linecolor rgb grey title (p == 1 ? 'runs' : ''), \
       '' index 2*p-2 using 1:3 with lines linewidth 0.8 dashtype (6,4) linecolor rgb palette[2] title (p == 1 ? 'mean' : ''), \
       '' index 2*p-2 using 1:2 with linespoints linewidth 1.2 pointtype 7 pointsize dot(0.35) linecolor rgb palette[1] title (p == 1 ? 'best' : '')
}
unset multiplot
