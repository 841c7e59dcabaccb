#!/usr/bin/env bash
# Draw the pictures of the labs' pages again, all in one style: labs/pictures.sh
# Those of the worlds are docs/pictures.py's, and need Chromium.
folder="$(cd "$(dirname "${BASH_SOURCE[0]}")/../docs" && pwd)"
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

snapshot() { # snapshot FILE OPTIONS...: a picture from behind a robot, or from above
    local file=$1
    shift
    show lcmtools sim snapshot --width 640 --height 400 --force "$@" "$folder/$file"
    check "$file is drawn" test "$code" -eq 0
}

show python "$folder/pictures.py"
check 'the worlds are drawn' test "$code" -eq 0

simulate /gazebo lcmtools run sim --world pioneer
snapshot path.png
show lcmtools run image_view image:=/camera/depth/image_raw --save "$folder/depth.png" --once --timeout 20
check 'depth.png is drawn' test "$code" -eq 0
end sim
finish
