# What all figures share. 333 x 96th of an inch are 88 mm, a column; 10 of them are letters of 7.5 pt.
# gnuplot -e "format='png'" FIGURE.gp draws a PNG of 300 dots per inch instead of an SVG.
if (!exists("format")) format = 'svg'
column = 333
dots = 300.0 / 96.0
open(height) = format eq 'png' \
  ? sprintf("set terminal pngcairo noenhanced size %d,%d font 'Helvetica,%g' linewidth %g pointscale %g background '#ffffff'", \
            column * dots, height * dots, 7.5 * dots, dots, dots) \
  : sprintf("set terminal svg noenhanced size %d,%d font 'Helvetica,10' background '#ffffff'", column, height)
set encoding utf8
set datafile missing 'NaN'
set border 3 linewidth 0.6 linecolor rgb '#444444'
set tics nomirror out scale 0.4
set xtics offset 0,0.4
set ytics offset 0.4,0
set key samplen 1.2 spacing 1.0 width 0
set style fill solid noborder
mode_colour(k) = palette[k % |palette| + 1]
mode_point(k) = (k / |palette|) % 3 == 0 ? 7 : (k / |palette|) % 3 == 1 ? 9 : 5
grey = '#9a9a9a'
band_colour = '#d0d0d0'
