"""The verbs of ``lcmtools srv``, one file each."""
