#!/bin/bash
# Help texts, and what wrong verbs and options get.
source "$(dirname "$0")/harness.bash"

for verb in setup build demo test lab vcan bench package check; do
    text=$("$rig" "$verb" --help)
    expect "$verb --help succeeds" $? 0
    check "$verb --help has an example" grep -q "^  ./rig $verb" <<<"$text"
    check "the overview names $verb" grep -q "./rig $verb" <<<"$("$rig")"
done

for name in faults soak fuzz mutate mcdc pil debian qemu; do
    text=$("$rig" check "$name" --help)
    expect "check $name --help succeeds" $? 0
    check "check $name --help has an example" grep -q "./rig check $name" <<<"$text"
    check "the list of checks names $name" grep -q "./rig check $name" <<<"$("$rig" check)"
done

refused() { # STATUS TEXT ARGS...
    local status=$1 text=$2 out
    shift 2
    out=$("$rig" "$@" 2>&1 >/dev/null)
    expect "status of: rig $*" $? "$status"
    check "its message names the cause" grep -qF -- "$text" <<<"$out"
}
refused 2 "there is no 'frobnicate'" frobnicate
refused 2 "there is no 'biuld'; did you mean 'build'?" biuld
for name in faults soak fuzz mutate mcdc pil debian qemu; do
    refused 2 "'$name' is ./rig check $name now" "$name" --help
done
refused 2 "there is no 'soka'; did you mean 'soak'?" check soka
refused 2 "no preset 'relese'; did you mean 'release'?" build relese
refused 2 "unknown option '--sclip'; did you mean '--slip'?" demo --lockstep --sclip 0.2
refused 2 "'now'" setup now
refused 2 "unknown option '--every'" test --every
refused 2 "takes no argument 'can'" test --all can
refused 2 "no room 'kitchen'" test can kitchen
refused 2 "'debug'" build debug
refused 2 "--colour" demo --colour red
refused 2 "--slip needs a value" demo --lockstep --slip
refused 2 "--scenario needs a value" demo --scenario
refused 2 "no scenario" demo --scenario moon
refused 2 "'11'" check debian 11
refused 2 "'icc'" check debian 13 icc
refused 2 "a command is missing" vcan
refused 2 "a command is missing" vcan --timeout 3 --
refused 2 "--timeout" vcan --timeout soon -- true
refused 2 "--timeout" vcan --timeout 0 -- true
refused 2 "--timeout" vcan --timeout=-1 -- true
refused 2 "--timeout" vcan --timeout nan -- true

completed() { # WORD...: what completion offers for the next one
    # shellcheck disable=SC2016
    bash -c 'source "$0"; COMP_WORDS=("$@" ""); COMP_CWORD=$#; _antiskid_rig "$1"; printf "%s\n" "${COMPREPLY[@]}"' \
        "$(dirname "$rig")/firmware/host/package/completion.bash" "$rig" "$@" | paste -sd ' '
}
check "completion offers the verbs" test "$(completed)" = "setup build demo test lab vcan bench package check"
check "completion offers the checks" test "$(completed check)" = "faults soak fuzz mutate mcdc pil debian qemu"
check "completion offers the presets" grep -q "release clang coverage" <<<"$(completed build)"
check "completion offers the rooms of tests" grep -qw control <<<"$(completed test)"
