#!/usr/bin/env bash
# The Pioneer lab, line by line: publishers and subscribers, a depth picture, driving by keys.
#
# Prints each command as one would type it and what came back, and ends with what it checked.
# Exit code 0 when all of it holds. It runs on a bus of its own (a domain), so that it disturbs
# nobody; LCMTOOLS_DOMAIN=N chooses which.
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

moves() { moving /ground_truth "$1" "$2"; }
chapter 'A talker and a listener'
show lcmtools node list
check 'nothing is on the bus: LCM needs no master' no_nodes
begin listener lcmtools run listener
within 30 has_node /listener
begin talker lcmtools run talker
within 30 said listener 'I heard: [hello world 20]'
cat "$logs/listener"
check 'the listener receives the texts' said listener 'I heard: [hello world 20]'
show lcmtools node list
check 'both are nodes' eval 'shown /talker && shown /listener'
show lcmtools list
check 'their topic is listed' shown /chatter
show lcmtools echo -n 2 /chatter
check 'echo prints the texts' shown 'data: "hello world'
show lcmtools hz /chatter -n 1 -w 20
check 'ten times a second (5 %)' grep -Eq 'average rate: (9\.[5-9]|10\.[0-4])' "$logs/shown"
end talker
end listener
check 'the listener missed nothing' python3 -c 'import re, sys
heard = [int(n) for n in re.findall(r"hello world (\d+)", open(sys.argv[1]).read())]
sys.exit(heard != list(range(heard[0], heard[0] + len(heard))))' "$logs/listener"

chapter 'An empty world'
simulate /gazebo lcmtools launch gazebo_ros empty_world.launch gui:=false
show lcmtools node list
check 'the simulator is a node' shown /gazebo
end sim
check 'Ctrl-C ends it' no_nodes

chapter 'Walls, tables, and a Pioneer with a Kinect'
simulate /gazebo lcmtools launch pre_assignment2 pre_assignment2.launch gui:=false
show lcmtools node list
show lcmtools list
check 'the camera and the robot are listed' \
    eval 'shown /camera/depth/image_raw && shown /RosAria/cmd_vel'
show lcmtools info /camera/depth/image_raw
check 'the depth picture is a sensor_msgs/Image' shown sensor_msgs/Image
show lcmtools info /RosAria/cmd_vel
check 'the velocity is a geometry_msgs/Twist' shown geometry_msgs/Twist

chapter 'The depth picture'
show lcmtools run image_view image:=/camera/depth/image_raw --save depth.png --once --timeout 20
check 'image_view saves a picture' eval 'file=depth.png; head -c 4 "$file" | grep -q PNG'
show lcmtools run kinect_viewer --save kinect.png --once --timeout 20
check 'kinect_viewer saves one too' eval 'head -c 4 kinect.png | grep -q PNG'
show lcmtools sim snapshot --robot / room.png
check 'the simulator shows the room' eval 'head -c 4 room.png | grep -q PNG'

chapter 'Driving by keys'
show lcmtools pub -1 /RosAria/cmd_vel geometry_msgs/Twist "{linear: {x: 0}, angular: {w: 0}}"
check 'pub reports that angular has no w' eval '[ "$code" -eq 2 ] && grep -q "angular.*w" "$logs/complaints"'
keyboard keys lcmtools run pioneer_manual_controller
for step in 'i 0.5 0' ', -0.5 0' 'j 0 1.0' 'l 0 -1.0' 'u 0.5 1.0' 'o 0.5 -1.0' 'm -0.5 -1.0' '. -0.5 1.0' 'k 0 0'; do
    read -r key along around <<< "$step"
    lcmtools sim set-pose / -1 0 > /dev/null # however far the key before has driven it
    keys "$key"
    check "key $key: $along m/s, $around rad/s" moves "$along" "$around"
done
lcmtools sim set-pose / -1 0 > /dev/null
keys q q i
check 'q twice: 0.605 m/s' moves 0.605 0
keys k
no_more_keys keys
lcmtools sim set-pose / -1 0 > /dev/null
press path 'i 1 k' lcmtools run pioneer_manual_controller
cat "$logs/path"
check 'one second forward is half a metre' \
    comes /ground_truth 'abs(pose.pose.position.x + 0.5) < 0.25 and abs(twist.twist.linear.x) < 0.01'
show lcmtools echo -n 1 /RosAria/pose

chapter 'The end'
end sim
check 'the simulator leaves the bus: no node is left' no_nodes
finish
