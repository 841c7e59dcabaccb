"""The live view of ``lcmtools spy``: the only place that knows textual."""
