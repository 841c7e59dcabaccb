"""The verbs of ``lcmtools param``, one file each."""
