"""Logs: recording what is on a bus, playing it, looking into it, and handing it on.

The logs are LCM's own, with an index beside them (``wire/log_index``); reading them as a stream of
arrivals is ``observe``'s. Nothing here prints or knows a command line.
"""
