"""``lcmtools sim``: controlling a running simulator.

Any node that offers the services of lcm_types/sim_msgs is a simulator here.
"""
