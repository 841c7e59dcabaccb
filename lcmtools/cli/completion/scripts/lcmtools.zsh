#compdef lcmtools
# lcmtools: completion for zsh; made by: lcmtools completion zsh

_lcmtools() {
    local line program=${(Q)words[1]/#\~\//$HOME/}
    local -a fields open open_shown closed closed_shown
    for line in "${(@f)$(_LCMTOOLS_COMPLETE=zsh "$program" "${(@)words[2,CURRENT-1]}" \
        "$QIPREFIX" "$IPREFIX$PREFIX" 2>/dev/null </dev/null)}"; do
        fields=("${(@ps:\t:)line}")
        case $fields[1] in
            files) _files; return ;;
            open) open+=("$fields[2]"); open_shown+=("$fields[3]") ;;
            closed) closed+=("$fields[2]"); closed_shown+=("$fields[3]") ;;
        esac
    done
    local -a how
    how=(-Q -U -V lcmtools)
    # a line each where there are words of explanation
    [[ "${closed_shown[*]}${open_shown[*]}" == *'  -- '* ]] && how+=(-l)
    (( $#closed )) && compadd "${(@)how}" -d closed_shown -- "${(@)closed}"
    (( $#open )) && compadd "${(@)how}" -S '' -d open_shown -- "${(@)open}"
    (( $#closed + $#open ))
}

if [[ $funcstack[1] == _lcmtools ]]; then
    _lcmtools "$@"
else
    compdef _lcmtools lcmtools
fi
