# Local models by component, in the projections of three parameters, with the components' 95 % ellipses.
# Data: block k the windows of component k, block K those of none; then an ellipse per component and panel.
panels = axes == 3 ? 3 : 1
eval open(panels == 3 ? 320 : 240)
set output figure.'.'.format
array first[3] = [1, 1, 2]
array second[3] = [2, 3, 3]
array low[3]
array high[3]
do for [i = 1:axes] {
  stats figure.'.dat' index 0:K using i nooutput
  # Stray windows do not shrink the cloud: quartiles and twice their distance, never more than there is.
  spread = STATS_up_quartile - STATS_lo_quartile
  low[i] = STATS_min > STATS_lo_quartile - 2.5 * spread ? STATS_min : STATS_lo_quartile - 2.5 * spread
  high[i] = STATS_max < STATS_up_quartile + 2.5 * spread ? STATS_max : STATS_up_quartile + 2.5 * spread
  if (high[i] <= low[i]) { low[i] = low[i] - 0.5; high[i] = high[i] + 0.5 }
  margin = 0.04 * (high[i] - low[i])
  low[i] = low[i] - margin
  high[i] = high[i] + margin
}
unset key
if (panels == 3) { set multiplot layout 2,2 margins 0.13,0.985,0.11,0.985 spacing 0.14,0.13 } else { set multiplot layout 1,1 }
do for [p = 1:panels] {
  set xrange [low[first[p]]:high[first[p]]]
  set yrange [low[second[p]]:high[second[p]]]
  set xlabel axis_label[first[p]] offset 0,0.9
  set ylabel axis_label[second[p]] offset 1.6,0
  set xtics autofreq (high[first[p]] - low[first[p]]) / 4 > 0.5 ? 1 : 0.5
  set xtics autofreq
  set xtics maxrev 5
  plot figure.'.dat' index K using first[p]:second[p] with points pointtype 1 pointsize 0.15 linecolor rgb grey notitle, \
       for [k = 0:K-1] '' index k using first[p]:second[p] with points pointtype mode_point(k) pointsize 0.12 linecolor rgb mode_colour(k) notitle, \
       for [k = 0:K-1] '' index K+1+3*k+p-1 using 1:2 with lines linewidth 2.2 linecolor rgb '#ffffff' notitle, \
       for [k = 0:K-1] '' index K+1+3*k+p-1 using 1:2 with lines linewidth 1.2 linecolor rgb mode_colour(k) notitle
}
if (panels == 3) {
  unset border
  unset tics
  unset xlabel
  unset ylabel
  set key at graph 0.0, graph 1.0 left top Left reverse maxrows 9 samplen 0.6
  set xrange [0:1]
  set yrange [0:1]
  plot for [k = 0:K-1] NaN with points pointtype mode_point(k) pointsize 0.6 linecolor rgb mode_colour(k) title component_title[k+1], \
       NaN with points pointtype 1 pointsize 0.6 linecolor rgb grey title rest_title
}
unset multiplot
