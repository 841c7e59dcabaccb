"""The rules behind ``wtf``: evidence is collected once, and rules turn it into findings.

Rules are plain functions from evidence to findings. No rule opens a socket, reads a clock or
prints, so that evidence in a file can be judged anywhere.
"""
