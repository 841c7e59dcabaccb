"""A camera's pictures, shown in the browser, in a terminal and in files.

``pixels`` reads a message, ``colors`` gives depth its colours and describes a picture, ``display``
writes lines and files, ``screen`` draws on a terminal, ``browser`` serves a page, and ``viewer``
chooses among them.
"""

from lcmtools.errors import needing_extra

with needing_extra("view", "showing pictures needs"):
    import PIL as PIL
