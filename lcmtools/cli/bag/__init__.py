"""The verbs of ``lcmtools bag``, one file each."""
