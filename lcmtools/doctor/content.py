"""Odd values in a message: numbers that are not finite, invalid rotations, covariances, times.

Pure: messages in, descriptions out. Values that look odd but have a meaning are listed here: a
laser's infinite range is a measurement, and -1 in an IMU's covariance means: unknown.
"""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, cast

from lcmtools.messages.fields import Field, visible_fields
from lcmtools.messages.registry import Message, type_name
from lcmtools.types.std_msgs import Time

if TYPE_CHECKING:  # the import is slow, and most looks do not need it
    from lcmtools.types.nav_msgs import Odometry

_FLOATS = ("float32", "float64")
_QUATERNION = "geometry_msgs/Quaternion"
_SECOND = 10**9  # [ns]
_NAN_ALLOWED = {  # as the types themselves define
    "sensor_msgs/LaserScan": {"ranges", "intensities", "range_max"},
    "sensor_msgs/LaserEcho": {"echoes"},
    "sensor_msgs/Range": {"range"},
    "sensor_msgs/NavSatFix": {"altitude"},
    "sensor_msgs/MagneticField": {"magnetic_field"},
    "sensor_msgs/BatteryState": {
        *("voltage", "temperature", "current", "charge", "capacity", "design_capacity"),
        *("percentage", "cell_voltage", "cell_temperature"),
    },
}
"""Fields in which NaN is legal (it means 'not measured'), by message type."""
_ODOMETRY = "nav_msgs/Odometry"
_STANDS = 0.05  # [m/s] and [rad/s]
_SQUARES = {9: 3, 36: 6}
_MOST_NUMBERS = 4096
_MOST_MESSAGES = 64
_TOLERANCE = 1e-6
_UNIT_TOLERANCE = 0.1

Odd = tuple[str, str]
"""A kind ("not-finite", "quaternion", "covariance", "nsec") and what is odd where.

"drives" is a robot's motion, which is odd only if nobody commands it.
"""


def oddities(message: Message, path: str = "") -> Iterator[Odd]:
    """Yield the odd values in a message."""
    cls = type(message)
    name = type_name(cls)
    if name == _QUATERNION:
        yield from _quaternion(message, path)
    elif name == _ODOMETRY:
        yield from _motion(cast("Odometry", message))
    elif isinstance(message, Time) and not 0 <= message.nsec < _SECOND:
        yield "nsec", f"{path}nsec is {message.nsec}, and a second has {_SECOND}"
    fields = visible_fields(cls)
    covariances = (one for one in fields if one.name.endswith("covariance"))
    unknown = (one.name for one in covariances if _is_unmeasured(getattr(message, one.attribute)))
    unmeasured = {name.removesuffix("_covariance") for name in unknown}
    for field in fields:
        if field.name not in unmeasured and field.name not in _NAN_ALLOWED.get(name, ()):
            yield from _field(getattr(message, field.attribute), field, f"{path}{field.name}")


def _motion(message: "Odometry") -> Iterator[Odd]:
    velocity = message.twist.twist
    speed, turn = math.hypot(velocity.linear.x, velocity.linear.y), abs(velocity.angular.z)
    if max(speed, turn) > _STANDS:
        yield "drives", f"drives at {speed:.2f} m/s, {turn:.2f} rad/s"


def _field(value: object, field: Field, path: str) -> Iterator[Odd]:
    if field.dimensions and isinstance(value, Sequence):
        yield from _array(value, field, path)
    elif not field.dimensions and field.message_class:
        yield from oddities(cast("Message", value), f"{path}.")
    elif not field.dimensions and field.type in _FLOATS and not math.isfinite(float(str(value))):
        yield "not-finite", f"{path} is {value}"


def _array(values: Sequence[object], field: Field, path: str) -> Iterator[Odd]:
    if len(field.dimensions) == 1 and field.type in _FLOATS:
        yield from _numbers(cast("Sequence[float]", values[:_MOST_NUMBERS]), path)
    elif len(field.dimensions) > 1 or field.message_class:
        part = field._replace(dimensions=field.dimensions[1:])
        for index, value in enumerate(values[:_MOST_MESSAGES]):
            yield from _field(value, part, f"{path}[{index}]")


def _numbers(values: Sequence[float], path: str) -> Iterator[Odd]:
    odd = [index for index, value in enumerate(values) if not math.isfinite(value)]
    if odd:
        more = f" and {len(odd) - 1} more" if len(odd) > 1 else ""
        yield "not-finite", f"{path}[{odd[0]}] is {values[odd[0]]}{more}"
    elif path.endswith("covariance") and len(values) in _SQUARES and not _is_unmeasured(values):
        yield from _covariance(values, path)


def _covariance(values: Sequence[float], path: str) -> Iterator[Odd]:
    side = _SQUARES[len(values)]
    tolerance = _TOLERANCE * max(map(abs, values))
    for row in range(side):
        if values[row * side + row] < 0:
            place = row * side + row
            yield "covariance", f"{path}[{place}], a variance, is {values[place]:g}"
            return
        for column in range(row):
            one, other = values[row * side + column], values[column * side + row]
            if abs(one - other) > tolerance:
                indices = f"[{row * side + column}] and [{column * side + row}]"
                yield "covariance", f"{path} is not symmetric: {indices} are {one:g} and {other:g}"
                return


def _is_unmeasured(values: object) -> bool:
    """Return whether a covariance begins with -1: not measured, as sensor_msgs/Imu defines."""
    return isinstance(values, Sequence) and len(values) > 0 and values[0] == -1


def _quaternion(message: object, path: str) -> Iterator[Odd]:
    where = path.rstrip(".") or "it"
    parts = [float(getattr(message, name)) for name in ("x", "y", "z", "w")]
    if not any(parts):
        yield "quaternion", f"{where} is all zeros, which is not a rotation; for no rotation w is 1"
        return
    norm = math.sqrt(sum(part * part for part in parts))
    if math.isfinite(norm) and abs(norm - 1) > _UNIT_TOLERANCE:
        yield "quaternion", f"{where} has the length {norm:.3g} instead of 1"
