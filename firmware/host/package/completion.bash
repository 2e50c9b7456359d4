# shellcheck shell=bash
# Options, verbs and values as the program's own --help lists them; file names where none fits. In zsh after `autoload -U bashcompinit; bashcompinit`.
_antiskid() {
    local program=$1 word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} verbs=() values='' i
    for ((i = 1; i < COMP_CWORD; ++i)); do
        [[ ${COMP_WORDS[i]} =~ ^[a-z]+$ ]] || break
        verbs+=("${COMP_WORDS[i]}")
    done
    if [[ $before == --* ]]; then
        values=$("$program" "${verbs[@]}" --help 2>/dev/null | sed -n "s/^  ${before} {\\([^}]*\\)}.*/\\1/p")
    fi
    if [[ -n $values ]]; then
        mapfile -t COMPREPLY < <(compgen -W "${values//,/ }" -- "$word")
    elif [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$("$program" "${verbs[@]}" --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]*' | sort -u)" -- "$word")
    else
        mapfile -t COMPREPLY < <(compgen -W "$("$program" "${verbs[@]}" --help 2>/dev/null | sed -n '/^Subcommands:/,/^$/ s/^  \([a-z][a-z-]*\) .*/\1/p')" -- "$word")
    fi
}
complete -o default -F _antiskid antiskid-controller rig-bridge rig-replay virtual-rig rig-lab
