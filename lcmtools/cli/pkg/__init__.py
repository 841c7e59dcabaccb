"""The verbs of ``lcmtools pkg``, one file each."""
