"""Types of the fields of .msg and .srv files."""

PRIMITIVES = {
    "bool": "boolean",
    **dict.fromkeys(("uint8", "char"), "byte"),
    "byte": "int8_t",
    **{f"{sign}int{bits}": f"int{bits}_t" for sign in ("", "u") for bits in (16, 32, 64)},
    "int8": "int8_t",
    "float32": "float",
    "float64": "double",
    **dict.fromkeys(("string", "wstring"), "string"),
    "time": "std_msgs.Time",
    "duration": "std_msgs.Duration",
    "Header": "std_msgs.Header",
}
"""Types of ROS, with those of LCM."""

MEANT = {
    **dict.fromkeys(("double", "float64_t"), "float64"),
    **dict.fromkeys(("float", "float32_t"), "float32"),
    **dict.fromkeys(("int", "integer", "long"), "int32 or int64"),
    **dict.fromkeys(("uint", "unsigned"), "uint32"),
    **dict.fromkeys(("boolean", "Bool"), "bool"),
    **dict.fromkeys(("str", "String"), "string"),
    **{f"{sign}int{bits}_t": f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}
"""Types of other languages, with those of ROS that may be meant."""
