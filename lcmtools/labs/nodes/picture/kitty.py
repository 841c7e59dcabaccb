"""Pictures as the kitty terminal's graphics protocol writes them. Pure.

https://sw.kovidgoyal.net/kitty/graphics-protocol/
"""

import base64
import zlib

from lcmtools.labs.nodes.picture.sample import View

QUERY = "\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\"
"""What a terminal that understands the protocol answers with ``YES``."""
YES = b"\x1b_Gi=31;OK"
CLEAR = "\x1b_Ga=d,d=A,q=2\x1b\\"
"""Takes all pictures away."""
_CHUNK = 4096


def draw_kitty(view: View, columns: int, lines: int) -> str:
    """A picture over so many columns and lines from the cursor on, which stays where it is."""
    content = base64.b64encode(zlib.compress(view.to_bytes(), 1)).decode("ascii")
    size = f"s={view.width},v={view.height},c={columns},r={lines}"
    head = f"a=T,f=24,o=z,i=1,p=1,q=2,C=1,{size},"
    chunks = [content[at : at + _CHUNK] for at in range(0, len(content), _CHUNK)]
    last = len(chunks) - 1
    return "".join(
        f"\x1b_G{head if number == 0 else ''}m={int(number < last)};{chunk}\x1b\\"
        for number, chunk in enumerate(chunks)
    )
