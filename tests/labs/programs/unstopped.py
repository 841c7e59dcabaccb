# lab check pioneer --path
# expects: no-stop | stops at the end | publish a final Twist of 0
# expects: goes-on | stops at the end | at the last point publish a Twist of 0

import sys

import lcmtools
from lcmtools.labs.nodes.path_follower import PathFollower


class Unstopped(PathFollower):
    def _odometry_callback(self, odometry):
        before = self._pursuit
        is_near = before and before.nearest >= len(before._points) - 4
        if is_near and sys.argv[1] == "goes-on":
            return
        super()._odometry_callback(odometry)
        after = self._pursuit
        if after and after.nearest >= len(after._points) - 4 and sys.argv[1] == "no-stop":
            lcmtools.shutdown()


lcmtools.init()
lcmtools.spin(Unstopped())
