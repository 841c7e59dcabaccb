"""The verbs of ``lcmtools msg``, one file each."""
