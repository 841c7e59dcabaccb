# lab check pioneer --viewer
# expects: right | nothing
# expects: upside-down | shows the depth | the picture is upside down

import sys
import PIL.Image
import lcmtools
from lcmtools import Node
from lcmtools.types.sensor_msgs import Image


def save(image):
    near = [min(255, low // 40 + 256 * high // 40)
            for low, high in zip(image.data[::2], image.data[1::2])]
    picture = PIL.Image.new("L", (image.width, image.height))
    picture.putdata(near)
    if sys.argv[1] == "upside-down":
        picture = picture.transpose(PIL.Image.Transpose.FLIP_TOP_BOTTOM)
    picture.save(sys.argv[-1])
    lcmtools.shutdown()


lcmtools.init()
node = Node("viewer")
node.create_subscription(Image, "/camera/depth/image_raw", save, 1)
lcmtools.spin(node)
