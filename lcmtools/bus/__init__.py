"""The outside: the lcm package and its sharp edges, the tap on a multicast group, processes.

The only package that opens sockets. It carries payloads without their meaning.
"""
