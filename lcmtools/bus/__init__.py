"""The outside world: the lcm package and its pitfalls, the tap on a multicast group, processes.

The only package that opens sockets. It carries payloads without knowing their meaning.
"""
