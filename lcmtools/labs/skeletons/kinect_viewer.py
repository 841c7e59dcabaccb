"""Show the Kinect's pictures (skeleton).

Run it with   python kinect_viewer.py   while the simulator runs: lcmtools run sim --world pioneer
Compare with   lcmtools run image_view image:=/camera/depth/image_raw
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes.picture.viewer import Viewer, open_viewer
from lcmtools.types.sensor_msgs import Image

TOPIC = "/camera/depth/image_raw"


class KinectViewer(Node):
    """Shows the pictures of the Kinect."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__("kinect_viewer")
        self.viewer = viewer
        # TODO: subscribe to Image on the topic TOPIC, so that kinect_callback is called with each
        # picture: self.create_subscription(TYPE, TOPIC, FUNCTION, 1)
        # The 1 keeps only the newest picture, should they come faster than they are shown.

    def kinect_callback(self, image: Image) -> None:
        """Show one picture. This is complete; look at image.encoding, width, height and data."""
        self.viewer.take(image)


def main(args: Sequence[str] | None = None) -> None:
    """Show pictures until Ctrl-C."""
    viewer = open_viewer(args, __doc__)  # by the command line: --save FILE, --once and more
    if viewer:
        lcmtools.init(args)
        viewer.run(KinectViewer(viewer), TOPIC)
        lcmtools.shutdown()


if __name__ == "__main__":
    main()
