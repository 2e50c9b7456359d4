#!/bin/bash
# A command under ./rig vcan cannot be told from one without: status, both outputs, environment, directory, arguments.
# shellcheck disable=SC2016 # expanded inside the guest
source "$(dirname "$0")/harness.bash"
cd "$scratch" || exit 1

# One guest for what does not need the exact status.
head -c 300000 /dev/urandom >bytes
mkdir 'odd dir'
cd 'odd dir' || exit 1
export ODD=$'two\nlines, "quotes", = and ü'
"$rig" vcan -- bash -c '
    cat ../bytes
    { printf "\r\n\0\033[0m\xff\n"; pwd; printf "%s\n" "$ODD" "$#" "$@"; } >&2
    [[ $(cat) == "" ]] && exit 3' name 'a b' '' $'c\nd' >../out 2>../err
expect "exit status 3" $? 3
check "300 kB of random bytes on standard output" cmp ../bytes ../out
{ printf '\r\n\0\033[0m\xff\n'; pwd; printf '%s\n' "$ODD" 3 'a b' '' $'c\nd'; } >../want
check "standard error apart, bytes intact; directory, environment, arguments" cmp ../want ../err
check "nothing is left" eventually 5 nothing_left

"$rig" vcan -- true >out 2>err
expect "exit status 0" $? 0
expect "and not a byte of noise" "$(cat out err)" ""

"$rig" vcan -- bash -c 'kill -SEGV $$' 2>/dev/null
expect "a command killed by SIGSEGV" $? 139

"$rig" vcan -- no-such-program 2>err
expect "a program that does not exist" $? 127
check "is named" grep -q no-such-program err

"$rig" vcan -- bash -c 'sleep 1000 & sleep 1000 & exit 0'
expect "background processes of the command do not hold it" $? 0

timeout 60 "$rig" vcan -- yes 2>/dev/null | head -n 1 >out
expect "a reader that leaves ends the command" "${PIPESTATUS[0]}" 141
check "nothing is left" eventually 5 nothing_left
