#!/usr/bin/env bash
# The Dolly lab, line by line: a node with a timer drives a circle, another one reads a laser.
#
# Prints each command as one would type it and what came back, and ends with what it checked.
# Exit code 0 when all of it holds. It runs on a bus of its own (a domain), so that it disturbs
# nobody; LCMTOOLS_DOMAIN=N chooses which.
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

moves() { moving /dolly/odom "$1" "$2"; }

chapter 'The simulator, and its topics'
simulate /gazebo lcmtools run sim --world dolly
show lcmtools list
for topic in /dolly/cmd_vel /dolly/laser_scan /dolly/odom /clock /tf; do
    check "$topic is listed" grep -qx "$topic" "$logs/shown"
done
show lcmtools info /dolly/cmd_vel
check 'it takes geometry_msgs/Twist' shown geometry_msgs/Twist
show lcmtools hz /dolly/laser_scan -n 1 -w 100
check 'the laser measures at 100 Hz (5 %)' grep -Eq 'average rate: (9[5-9]|10[0-4])\.' "$logs/shown"
check 'the Dolly is at rest' moves 0 0

chapter 'A subscriber: reading_laser'
begin laser lcmtools run reading_laser
within 30 said laser 'nearest'
end laser
cat "$logs/laser"
check 'it prints ranges in metres' eval 'grep -Eq "[0-9]+\.[0-9]+ m" "$logs/laser"'
check 'and ends on Ctrl-C' test "$code" -eq 0

chapter 'A publisher: moving_robot'
begin mover lcmtools run moving_robot
within 30 has_node /moving_robot
check 'it drives at 0.5 m/s and turns at 0.3 rad/s' moves 0.5 0.3
show lcmtools hz /dolly/cmd_vel --wall-time -n 1 -w 8 --timeout 20s
check 'commands come at 2 Hz (5 %)' grep -Eq 'average rate: (1\.9|2\.0)' "$logs/shown"
show lcmtools echo -n 1 /dolly/cmd_vel
check 'each has 0.5 and 0.3' eval 'shown "x: 0.5" && shown "z: 0.3"'
show lcmtools node info moving_robot
check 'node info names the topic' shown /dolly/cmd_vel
lcmtools echo --csv -n 200 /dolly/ground_truth/pose.pose.position > "$logs/path" 2> /dev/null
check 'its circle has a radius of 1.667 m (2 %)' python3 -c 'import csv, math, sys
rows = [row for row in csv.reader(open(sys.argv[1])) if row and row[-1][-1:].isdigit()]
places = [(float(row[-3]), float(row[-2])) for row in rows]
(ax, ay), (bx, by), (cx, cy) = places[0], places[len(places) // 2], places[-1]
a, b, c = math.dist((bx, by), (cx, cy)), math.dist((ax, ay), (cx, cy)), math.dist((ax, ay), (bx, by))
area = abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2
sys.exit(abs(a * b * c / (4 * area) - 5 / 3) > 0.033)' "$logs/path"
tail -n 3 "$logs/mover"
end mover
check 'it ends on Ctrl-C' test "$code" -eq 0
show lcmtools pub -1 /dolly/cmd_vel geometry_msgs/Twist
check 'an empty Twist stops the Dolly' moves 0 0

chapter 'The end'
end sim
check 'the simulator leaves the bus: no node is left' no_nodes
finish
