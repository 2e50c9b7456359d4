# shellcheck shell=bash disable=SC2034
# Sourced by the tests beside it. A test is a script that calls `check` or `expect`; the first that fails ends it.
set -uo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rig=$(cd "$here/../.." && pwd)/rig
scratch=$(mktemp -d)
# Job directories of ./rig vcan come here too, so that each test sees its own leftovers only.
export TMPDIR=$scratch/tmp
mkdir "$TMPDIR"
trap 'rm -rf "$scratch"' EXIT

check() { # WHAT COMMAND...
    local what=$1
    shift
    if "$@"; then
        echo "ok      $what"
    else
        echo "FAILED  $what: $*" >&2
        exit 1
    fi
}

expect() { # WHAT ACTUAL EXPECTED
    if [[ $2 == "$3" ]]; then
        echo "ok      $1"
    else
        printf 'FAILED  %s\n  expected: %q\n  got:      %q\n' "$1" "$3" "$2" >&2
        exit 1
    fi
}

# Waits until COMMAND succeeds; a bound on hanging, not a measurement.
eventually() { # SECONDS COMMAND...
    local tries=$(($1 * 20))
    shift
    while ! "$@"; do
        [[ $((tries -= 1)) -gt 0 ]] || return 1
        sleep 0.05
    done
}

# No process, alive or a helper of a guest, mentions this test's job directories, and no directory is left.
nothing_left() {
    local cmdline
    for cmdline in /proc/[0-9]*/cmdline; do
        ! tr '\0' ' ' 2>/dev/null <"$cmdline" | grep -qF "$TMPDIR/rig-vcan" || return 1
    done
    [[ -z $(ls -A "$TMPDIR") ]]
}

has_line() { # FILE LINE
    grep -qxF -- "$2" "$1" 2>/dev/null
}
