"""Show the Kinect's pictures, live in the browser or in the terminal.

Subscribes:
    /camera/depth/image_raw   sensor_msgs/Image             depth (16UC1, 32FC1), grey or colour
                              sensor_msgs/CompressedImage   the same as a PNG file

Near is light, far is dark, and black is no reading. Ctrl-C ends it, in the terminal also q.

Example:
    lcmtools run sim --world pioneer
    lcmtools run kinect_viewer
    lcmtools run kinect_viewer --save depth.png --once
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes.picture.viewer import Viewer, open_viewer
from lcmtools.types.sensor_msgs import CompressedImage, Image


class KinectViewer(Node):
    """Shows the pictures of the Kinect."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__("kinect_viewer")
        # only the newest picture counts: an old one that waited would be shown too late
        self.subscription = self.create_subscription(
            (Image, CompressedImage), "/camera/depth/image_raw", viewer.take, 1
        )


def main(args: Sequence[str] | None = None) -> None:
    """Show pictures until Ctrl-C."""
    viewer = open_viewer(args, __doc__)
    if viewer:
        lcmtools.init(args)
        node = KinectViewer(viewer)
        viewer.run(node, node.subscription.topic)
        lcmtools.shutdown()
