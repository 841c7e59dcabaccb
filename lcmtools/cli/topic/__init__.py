"""The verbs of ``lcmtools topic``, one file each."""
