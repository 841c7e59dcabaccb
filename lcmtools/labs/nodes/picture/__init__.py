"""Showing a camera's pictures: in a terminal, in a window, in files, by Pillow and textual-image.

``pixels`` reads a message, ``colors`` gives depth its colours and describes a picture, ``display``
writes lines and files, ``screen`` and ``window`` show it, and ``viewer`` decides when.
"""

from lcmtools.errors import needing_extra

with needing_extra("view", "showing pictures needs"):
    import PIL as PIL
