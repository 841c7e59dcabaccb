"""The robot models, one file each; a world file names them by their key here."""

from lcmtools_sim.robots.dolly import DOLLY
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.robots.model import RobotModel
from lcmtools_sim.robots.pioneer import PIONEER

MODELS: dict[str, RobotModel] = {model.name: model for model in (HUSKY, PIONEER, DOLLY)}
