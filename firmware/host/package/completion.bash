# shellcheck shell=bash
# Options, verbs and values as the program's own --help lists them; file names where none fits. In zsh after `autoload -U bashcompinit; bashcompinit`.
_antiskid() {
    local program=$1 word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} verbs=() values='' help i
    for ((i = 1; i < COMP_CWORD; ++i)); do
        [[ ${COMP_WORDS[i]} =~ ^[a-z]+$ ]] || break
        verbs+=("${COMP_WORDS[i]}")
    done
    help=$("$program" "${verbs[@]}" --help 2>/dev/null)
    if [[ $before == --* ]]; then
        values=$(sed -n "s/^  ${before} {\\([^}]*\\)}.*/\\1/p" <<<"$help")
    fi
    if [[ -n $values ]]; then
        mapfile -t COMPREPLY < <(compgen -W "${values//,/ }" -- "$word")
    elif [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(grep -oE -- '--[a-z][a-z-]*' <<<"$help" | sort -u)" -- "$word")
    else
        mapfile -t COMPREPLY < <(compgen -W "$(sed -n '/^Subcommands:/,/^$/ s/^  \([a-z][a-z-]*\) .*/\1/p' <<<"$help")" -- "$word")
    fi
}

# Of ./rig in the source: `source firmware/host/package/completion.bash`.
_antiskid_rig() {
    local rig=$1 verb=${COMP_WORDS[1]-} word=${COMP_WORDS[COMP_CWORD]} pattern='' rooms help
    if [[ $verb == lab && COMP_CWORD -gt 1 ]]; then
        COMP_WORDS=("$(dirname "$rig")/build/release/bin/rig-lab" "${COMP_WORDS[@]:2}")
        COMP_CWORD=$((COMP_CWORD - 1))
        _antiskid "${COMP_WORDS[0]}"
        return
    fi
    help=$("$rig" "${COMP_WORDS[@]:1:COMP_CWORD-1}" --help 2>/dev/null)
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(grep -oE -- '--[a-z][a-z-]*' <<<"$help" | sort -u)" -- "$word")
    elif [[ $verb == test && COMP_CWORD -gt 1 ]]; then
        rooms=$(cd "$(dirname "$rig")/tests" && printf '%s\n' */CMakeLists.txt)
        mapfile -t COMPREPLY < <(compgen -W "${rooms//\/CMakeLists.txt/}" -- "$word")
    elif [[ COMP_CWORD -eq 1 || (COMP_CWORD -eq 2 && $verb =~ ^(build|check|setup)$) ]]; then
        [[ COMP_CWORD -eq 1 ]] || pattern="$verb "
        mapfile -t COMPREPLY < <(compgen -W "$(sed -n "s/^  .\/rig $pattern\([a-z]\+\).*/\1/p" <<<"$help")" -- "$word")
    fi
}
# Installed, it leaves alone the `rig` that Debian has.
[[ ${BASH_SOURCE[0]} != *firmware/host/package/* ]] || complete -o default -F _antiskid_rig rig
complete -o default -F _antiskid antiskid-controller rig-bridge rig-replay virtual-rig rig-lab
