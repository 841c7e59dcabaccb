# lcmtools: completion for bash; made by: lcmtools completion bash

_lcmtools_completion() {
    local answer line how=
    COMPREPLY=()
    answer=$(_LCMTOOLS_COMPLETE=bash "${1/#\~\//$HOME/}" "${COMP_LINE:0:COMP_POINT}" \
        "$COMP_WORDBREAKS" 2>/dev/null </dev/null) || return 0
    while IFS= read -r line; do
        if [ -z "$how" ]; then
            how=$line
        elif [ -n "$line" ]; then
            COMPREPLY+=("$line")
        fi
    done <<< "$answer"
    case $how in
        open) compopt -o nospace 2>/dev/null ;;
        files) compopt -o default -o bashdefault 2>/dev/null ;;
    esac
    return 0
}

complete -o nosort -F _lcmtools_completion lcmtools 2>/dev/null ||
    complete -F _lcmtools_completion lcmtools
