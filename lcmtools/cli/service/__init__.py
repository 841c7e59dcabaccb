"""The verbs of ``lcmtools service``, one file each."""
