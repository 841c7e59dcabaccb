"""The verbs of ``lcmtools service``, by what they do."""
