# What all figures share. 333 x 96th of an inch are 88 mm, a column; 10 of them are letters of 7.5 pt.
# gnuplot -e "format='pdf'" FIGURE.gp draws a PDF whose fonts are embedded, format='png' a PNG of 600 dots per inch
# instead of an SVG. The PDF's terminal takes three quarters of a point for one.
if (!exists("format")) format = 'svg'
column = 333
dots = 600.0 / 96.0
inch = 96.0
open(height) = format eq 'png' \
  ? sprintf("set terminal pngcairo noenhanced size %d,%d font 'Helvetica,%g' linewidth %g pointscale %g background '#ffffff'", \
            column * dots, height * dots, 7.5 * dots, dots, dots) \
  : format eq 'pdf' \
  ? sprintf("set terminal pdfcairo noenhanced size %.4fin,%.4fin font 'Helvetica,7.5' fontscale 0.75 linewidth 1.3 pointscale 0.9 background '#ffffff'", \
            column / inch, height / inch) \
  : sprintf("set terminal svg noenhanced size %d,%d font 'Helvetica,10' background '#ffffff'", column, height)
set encoding utf8
set datafile missing 'NaN'
# Labels of vertical axes are labels of the picture: gnuplot leaves out a ylabel that long numbers push over the edge.
set border 3 linewidth 0.6 linecolor rgb '#444444'
set tics nomirror out scale 0.4
set xtics offset 0,0.4
set ytics offset 0.4,0
set style fill solid noborder
legend_font = sprintf(',%g', format eq 'png' ? 7 * dots : format eq 'pdf' ? 7 : 9.3)
# A legend in two rows above a plot, at this height of the picture.
legend(height) = sprintf("set key at screen left_edge,%g left top Left reverse vertical maxrows 2 samplen 1.2 width -0.5 font '%s'", height, legend_font)
left_edge = 0.15
right_edge = 0.985
# Sizes of points are not scaled alike by the terminals.
dot(size) = format eq 'svg' ? 1.7 * size : size
grey = '#9a9a9a'
band_colour = '#d0d0d0'
accepted_colour = '#e6e6e6'
# Of the groups that are told apart the palette's, of all others together grey.
layer_colour(k) = k <= told_apart ? palette[k] : grey
# A round distance between tics, about `count` of them in `range`.
power(range, count) = 10.0 ** floor(log10(range / count))
round_tic(range, count) = range / count / power(range, count) > 5 ? 10 * power(range, count) \
  : range / count / power(range, count) > 2 ? 5 * power(range, count) \
  : range / count / power(range, count) > 1 ? 2 * power(range, count) : power(range, count)
