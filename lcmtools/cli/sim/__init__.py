"""``lcmtools sim``: steering a simulator that runs.

Any node that offers the services of lcm_types/sim_msgs is a simulator here.
"""
