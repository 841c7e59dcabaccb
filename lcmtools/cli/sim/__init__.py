"""``lcmtools sim``: steering a simulator that runs, one file a verb.

Any node that offers the services of lcm_types/sim_msgs is a simulator here.
"""
