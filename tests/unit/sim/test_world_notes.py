"""Notes on world files that are no errors."""

from lcmtools_sim.world_file import read_scene

WORLD = """\
dt: 1/240
robots:
  - model: husky
    namespace: /a
    sensors:
      - {type: imu, topic: imu, rate: 240}
      - {type: laser, topic: scan, rate: 1000}
"""


def test_a_sensor_with_a_rate_above_that_of_the_steps_is_noted():
    assert read_scene(WORLD, "yard.yaml").notes == (
        "yard.yaml:3: scan of /a cannot have 1000 Hz: there are 240 steps a second",
    )
