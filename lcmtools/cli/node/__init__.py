"""The verbs of ``lcmtools node``, one file each."""
