# The three panels of Fig. 12 from DIR/trajectory.csv (columns by name); run as: gnuplot -e "dir='DIR'" maneuver.gp
set datafile separator ","
set terminal pngcairo size 1100,1200
set output dir."/maneuver.png"
file = dir."/trajectory.csv"
set multiplot layout 3,1
set grid
set xlabel "time / s"
set key top right

set ylabel "speed / (m/s)"
plot file using "time_s":"speed_mps" with lines lw 2 title "aircraft", \
     file using "time_s":(column("wheel_speed_radps") * column("radius_m")) with lines title "wheel rim"

set ylabel "slip"
set yrange [0:1]
plot file using "time_s":"slip" with lines title "slip", \
     file using "time_s":"slip_reference" with lines lw 2 title "reference"

set ylabel "pressure / bar"
set yrange [0:*]
plot file using "time_s":(column("demand_Pa") / 1e5) with lines lw 2 title "requested by the pilot", \
     file using "time_s":(column("pressure_Pa") / 1e5) with lines title "applied"
unset multiplot
