"""Showing a camera's pictures: in a terminal, in a window, in files; without numpy.

A picture goes one way: ``pixels`` reads a message (``png`` what is compressed), ``sample`` takes
the pixels that there is room for, ``shades`` gives them colours, and ``blocks``, ``sixel``,
``kitty`` or ``png`` write them down. All that is pure; ``display``, ``screen`` and ``window`` are
where it is shown, ``viewer`` decides when. Only the pixels that are shown are looked at, which is
why plain Python is fast enough.
"""
