# Picture of a posterior: draws of x and y, and the marginals of x, y and yaw, about their
# means and up to four standard deviations from them. README's picture is made, after
# scripts/demo, by
#   gnuplot -c scripts/mug_posterior.gp build/demo/samples.csv docs/images/mug_posterior.png
samples = ARG1
picture = ARG2

set datafile separator ','
set datafile columnheaders
set terminal pngcairo size 1200, 600 font 'sans,11'
set output picture

# Columns of samples.csv: chain, draw, x_m, y_m, z_m, roll_rad, pitch_rad, yaw_rad.
column_x = 3
column_y = 4
column_yaw = 8
stats samples using 1 name 'chain' nooutput
stats samples using column_x name 'x' nooutput
stats samples using column_y name 'y' nooutput
stats samples using (sin(column(column_yaw))) name 'sine' nooutput
stats samples using (cos(column(column_yaw))) name 'cosine' nooutput
mean_yaw = atan2(sine_mean, cosine_mean)
yaw_about_mean(yaw) = atan2(sin(yaw - mean_yaw), cos(yaw - mean_yaw))
stats samples using (yaw_about_mean(column(column_yaw))) name 'yaw' nooutput

mm = 1000.0
degree = 180.0 / pi
num_bins = 40
set style fill solid 0.6 noborder
bin(value, width) = width * (floor(value / width) + 0.5)
reach_of(deviation) = deviation > 0.0 ? 4.0 * deviation : 1.0
width_of(deviation) = 2.0 * reach_of(deviation) / num_bins

set multiplot
set grid
unset key
set title sprintf('Draws of x and y about their mean, (%.4f, %.4f) m', x_mean, y_mean)
set xlabel 'x [mm]'
set ylabel 'y [mm]'
set size 0.5, 1.0
set origin 0.0, 0.0
set key top right title 'chain'
set xrange [-mm * reach_of(x_stddev):mm * reach_of(x_stddev)]
set yrange [-mm * reach_of(y_stddev):mm * reach_of(y_stddev)]
plot for [i = int(chain_min) : int(chain_max)] samples \
  using (column(1) == i ? mm * (column(column_x) - x_mean) : NaN) \
        :(mm * (column(column_y) - y_mean)) \
  with points pointtype 7 pointsize 0.4 title sprintf('%d', i)

unset key
unset title
set ylabel 'draws'
set yrange [0:*]
set size 0.5, 0.33
set boxwidth 0.9 relative

set origin 0.5, 0.67
plot samples using (bin(mm * (column(column_x) - x_mean), mm * width_of(x_stddev))):(1) \
  smooth frequency with boxes

set origin 0.5, 0.34
set xlabel 'y [mm]'
set xrange [-mm * reach_of(y_stddev):mm * reach_of(y_stddev)]
plot samples using (bin(mm * (column(column_y) - y_mean), mm * width_of(y_stddev))):(1) \
  smooth frequency with boxes

set origin 0.5, 0.01
set xlabel sprintf('yaw [degrees], about the mean of %.2f', degree * mean_yaw)
set xrange [-degree * reach_of(yaw_stddev):degree * reach_of(yaw_stddev)]
plot samples using (bin(degree * yaw_about_mean(column(column_yaw)), \
                        degree * width_of(yaw_stddev))):(1) \
  smooth frequency with boxes
unset multiplot
