"""What ``wtf`` knows: evidence is collected once, and rules turn it into findings.

Rules are plain functions from evidence to findings; no rule opens a socket, reads a clock or
prints, so a stranger's evidence can be judged anywhere.
"""
