"""Byte formats of LCM, without any input or output: bytes in, values out, and back."""
