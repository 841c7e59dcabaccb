"""Completing command lines in bash, zsh and fish.

    answer      a shell's question to its answer: the only door, and silent whatever happens
    shells      what bash, zsh and fish hand over, and how each wants words quoted
    typed       a line as typed: words without their quotes
    tree        the commands, options and arguments as plain data, kept in a file
    line        which of them the word under the cursor is
    candidate   a word that could stand there
    words/      what can stand there: one file a kind of word
    situation   what those know: the words before, and the bus at a glance
    heard       channels remembered from one completion to the next
    scripts/    the shells' side
    install     where a script goes, for good
    places      the user's folders
    command     ``lcmtools completion``

A completion answers in well under 150 ms: click, the commands and lcm are not imported.
"""
