"""Completing command lines in bash, zsh and fish.

    bus, messages, programs, logs
                the completers: functions from a situation to candidates
    situation   the words before the cursor, the bus at a glance; candidates
    recorded    a log at a glance, in place of the bus
    tree        the commands, options and arguments as plain data, from a file
    from_click  the file, made from the commands; never imported by a completion
    line        the option or argument that the word under the cursor belongs to
    answer      the entry point: requests and answers of bash, zsh and fish, with their quoting
    install, completion, scripts/
                ``lcmtools completion`` and the shells' side

A completion answers in well under 150 ms: click, the commands and lcm are not imported, and to
know the bus no dataclass is made, for which Python would read ten modules.
"""

from collections.abc import Sequence

Source = str | Sequence[Sequence[str]]
"""The origin of a parameter's candidates: words, each alone or with its help; or "module:function",
"files", "" for nowhere. A module without a dot is one of this package."""
