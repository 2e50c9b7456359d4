# shellcheck shell=bash
# Options and verbs as the program's own --help lists them; file names where none fits.
_antiskid() {
    local program=$1 word=${COMP_WORDS[COMP_CWORD]} verbs=() i
    for ((i = 1; i < COMP_CWORD; ++i)); do
        [[ ${COMP_WORDS[i]} =~ ^[a-z]+$ ]] || break
        verbs+=("${COMP_WORDS[i]}")
    done
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$("$program" "${verbs[@]}" --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]*' | sort -u)" -- "$word")
    else
        mapfile -t COMPREPLY < <(compgen -W "$("$program" "${verbs[@]}" --help 2>/dev/null | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z-]*\) .*/\1/p')" -- "$word")
    fi
}
complete -o default -F _antiskid antiskid-controller rig-bridge rig-replay virtual-rig rig-lab
