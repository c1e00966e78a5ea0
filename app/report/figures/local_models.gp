# Local models by component, in the projections of three parameters, with the components' 95 % ellipses.
# Data: block k the windows of the component at place k, the heaviest first, block K all others; then an ellipse per
# component and panel; then the bank's modes.
panels = axes == 3 ? 3 : 1
eval open(panels == 3 ? 320 : 240)
if (!exists('drawn')) drawn = figure.'.'.format
set output drawn
array first[3] = [1, 1, 2]
array second[3] = [2, 3, 3]
array low[3]
array high[3]
do for [i = 1:axes] {
  stats figure.'.dat' index 0:K using i nooutput
  # Stray windows do not shrink the cloud: the range holds the quartiles and 2.5 times their distance, and two standard
  # deviations, where there are windows; ellipses may widen it by a quarter.
  spread = 2.5 * (STATS_up_quartile - STATS_lo_quartile)
  lowest = STATS_lo_quartile - spread < STATS_mean - 2 * STATS_stddev ? STATS_lo_quartile - spread : STATS_mean - 2 * STATS_stddev
  highest = STATS_up_quartile + spread > STATS_mean + 2 * STATS_stddev ? STATS_up_quartile + spread : STATS_mean + 2 * STATS_stddev
  low[i] = STATS_min > lowest ? STATS_min : lowest
  high[i] = STATS_max < highest ? STATS_max : highest
  room = 0.25 * (high[i] - low[i])
  below = low[i]
  above = high[i]
  do for [k = 0:K-1] {
    stats figure.'.dat' index K+1+3*k+(i == 3 ? 1 : 0) using (i == 1 ? $1 : $2) nooutput
    if (STATS_min < below) { below = STATS_min }
    if (STATS_max > above) { above = STATS_max }
  }
  low[i] = below > low[i] - room ? below : low[i] - room
  high[i] = above < high[i] + room ? above : high[i] + room
  if (high[i] <= low[i]) { low[i] = low[i] - 0.5; high[i] = high[i] + 0.5 }
  margin = 0.04 * (high[i] - low[i])
  low[i] = low[i] - margin
  high[i] = high[i] + margin
}
unset key
if (panels == 3) { set multiplot layout 2,2 margins 0.15,0.985,0.11,0.985 spacing 0.155,0.13 } else { set multiplot layout 1,1 margins 0.15,0.985,0.15,0.985 }
do for [p = 1:panels] {
  set xrange [low[first[p]]:high[first[p]]]
  set yrange [low[second[p]]:high[second[p]]]
  set xtics round_tic(high[first[p]] - low[first[p]], 5)
  set ytics round_tic(high[second[p]] - low[second[p]], 6)
  set xlabel axis_label[first[p]] offset 0,0.9 font legend_font
  set label 100 axis_label[second[p]] at graph -0.36, graph 0.5 center rotate by 90 font legend_font
  plot figure.'.dat' index K using first[p]:second[p] with points pointtype 1 pointsize dot(0.15) linecolor rgb grey notitle, \
       for [k = 0:K-1] '' index k using first[p]:second[p] with points pointtype 7 pointsize dot(0.12) linecolor rgb component_colour[k+1] notitle, \
       for [k = 0:K-1] '' index K+1+3*k+p-1 using 1:2 with lines linewidth 2.2 linecolor rgb '#ffffff' notitle, \
       for [k = 0:K-1] '' index K+1+3*k+p-1 using 1:2 with lines linewidth 1.2 linecolor rgb component_colour[k+1] notitle, \
       for [i = 1:(modes > 0 ? 1 : 0)] '' index 4*K+1 using first[p]:second[p] with points pointtype 13 pointsize dot(0.75) linecolor rgb '#ffffff' notitle, \
       for [i = 1:(modes > 0 ? 1 : 0)] '' index 4*K+1 using first[p]:second[p] with points pointtype 13 pointsize dot(0.5) linecolor rgb '#000000' notitle
}
if (panels == 3) {
  unset border
  unset tics
  unset xlabel
  unset ylabel
  unset label 100
  unset key
  set xrange [0:1]
  set yrange [0:1]
  set label 1 key_title at graph 0.0, graph 0.97
  do for [k = 0:K] {
    y = 0.86 - 0.085 * k
    name = k < K ? component_title[k+1] : rest_title
    colour = k < K ? component_colour[k+1] : grey
    set label k+2 name at graph 0.05, graph y left offset 0.8,-0.1 point pointtype 7 pointsize dot(0.4) linecolor rgb colour
  }
  if (modes > 0) {
    set label K+3 'mode of the bank' at graph 0.05, graph 0.86-0.085*(K+1) left offset 0.8,-0.1 point pointtype 13 pointsize dot(0.5) linecolor rgb '#000000'
  }
  plot NaN notitle
}
unset multiplot
