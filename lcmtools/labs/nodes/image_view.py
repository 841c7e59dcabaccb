"""Show the pictures of any topic, live in the browser or in the terminal.

Subscribes:
    image   sensor_msgs/Image             depth (16UC1, 32FC1), grey (mono8, mono16) or colour
                                          (rgb8, bgr8, rgba8, bgra8)
            sensor_msgs/CompressedImage   the same as a PNG file

Of depth, near is light, far is dark, and black is no reading.
Ctrl-C ends it, in the terminal also q.

Example:
    lcmtools run image_view image:=/camera/depth/image_raw
    lcmtools run image_view image:=/camera/rgb/image_raw/compressed
    lcmtools run image_view image:=/camera/depth/image_raw --save depth%04d.png --rate 1
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes.picture.viewer import Viewer, open_viewer
from lcmtools.types.sensor_msgs import CompressedImage, Image


class ImageView(Node):
    """Shows the pictures of a topic."""

    def __init__(self, viewer: Viewer) -> None:
        super().__init__("image_view")
        # only the newest picture counts: an old one that waited would be shown too late
        self.subscription = self.create_subscription(
            (Image, CompressedImage), "image", viewer.take, 1
        )
        if self.subscription.topic.endswith("/image"):
            self.get_logger().warning(
                f"pictures are expected on {self.subscription.topic}; for another topic add"
                " image:=/camera/depth/image_raw, for example"
            )


def main(args: Sequence[str] | None = None) -> None:
    """Show pictures until Ctrl-C."""
    viewer = open_viewer(args, __doc__)
    if viewer:
        lcmtools.init(args)
        node = ImageView(viewer)
        viewer.run(node, node.subscription.topic)
        lcmtools.shutdown()
