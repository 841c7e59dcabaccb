#!/usr/bin/env bash
# Draw the pictures of the labs' pages again, all in one style: labs/pictures.sh
folder="$(cd "$(dirname "${BASH_SOURCE[0]}")/../docs" && pwd)"
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

snapshot() { # snapshot FILE OPTIONS...: a picture from behind a robot, or from above
    local file=$1
    shift
    show lcmtools sim snapshot --width 640 --height 400 --force "$@" "$folder/$file"
    check "$file is drawn" test "$code" -eq 0
}

simulate /morse lcmtools run sim --world husky
snapshot husky.png --robot /husky0
end sim
simulate /gazebo lcmtools run sim --world dolly
snapshot dolly.png --robot /dolly
end sim
simulate /gazebo lcmtools run sim --world pioneer
snapshot pioneer.png --robot /
snapshot path.png
show lcmtools run image_view image:=/camera/depth/image_raw --save "$folder/depth.png" --once --timeout 20
check 'depth.png is drawn' test "$code" -eq 0
end sim
finish
