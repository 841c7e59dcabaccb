# lcmtools: completion for fish; made by: lcmtools completion fish

function __lcmtools_complete
    set -l tokens (commandline -opc)
    set -l word (commandline -ct)
    set -l program $tokens[1]
    set -e tokens[1]
    set -lx _LCMTOOLS_COMPLETE fish
    set -l answer (command $program $tokens "$word" 2>/dev/null </dev/null)
    if test "$answer" = files
        __fish_complete_path "$word"
    else if test (count $answer) -gt 0
        printf '%s\n' $answer
    end
end

complete -c lcmtools -e
complete -c lcmtools -f -k -a '(__lcmtools_complete)'
