#!/bin/bash
# The choreography of ./rig demo with stand-ins for the two programs: real candump, real vcan0.
source "$(dirname "$0")/harness.bash"

build=$scratch/build
out=$scratch/out
mkdir -p "$build/bin"

programs() { # CONTROLLER VIRTUAL_RIG: bodies of the stand-ins
    printf '#!/bin/bash\nout=%q\n%s\n' "$scratch" "$1" >"$build/bin/antiskid-controller"
    printf '#!/bin/bash\nout=%q\n%s\n' "$scratch" "$2" >"$build/bin/virtual-rig"
    chmod +x "$build/bin/virtual-rig" "$build/bin/antiskid-controller"
    rm -rf "$out" "$scratch"/{events,*.seen}
    mkdir "$out"
}

demo() {
    "$rig" vcan --timeout 100 -- "$here/../../firmware/host/vcan/demo" "$build" "$out" sync --slip 0.2 >"$scratch/stdout" 2>"$scratch/stderr"
}

# shellcheck disable=SC2016 # expanded in the stand-ins
{
    controller='trap "echo controller ended >>$out/events; exit 0" TERM; echo "controller $*" >>$out/events; while :; do sleep 0.1; done'
    virtual_rig='until ls /dev/shm/bus.*/candump-*.log >/dev/null 2>&1; do sleep 0.05; done; sleep 0.2
        until grep -qs controller $out/events; do sleep 0.05; done
        echo "rig $*" >>$out/events; for i in {1..200}; do cansend vcan0 080#; done; echo table; echo "rig ended" >>$out/events'
    stuck_rig='trap "echo rig ended >>$out/events; exit 7" TERM; touch $out/rig.seen; while :; do sleep 0.1; done'
    dead_controller='until [[ -e $out/rig.seen ]]; do sleep 0.1; done; exit 4'
    crashed_controller='until [[ -e $out/rig.seen ]]; do sleep 0.1; done; kill -SEGV $$'
    failing_rig='until grep -qs controller $out/events; do sleep 0.05; done; echo "rig ended" >>$out/events; exit 5'
    recorder_killer='trap "echo controller ended >>$out/events; exit 0" TERM
        until [[ -e $out/rig.seen ]]; do sleep 0.1; done; pkill -KILL -x candump; while :; do sleep 0.1; done'
    bad_end='trap "exit 6" TERM; echo controller >>$out/events; while :; do sleep 0.1; done'
}

programs "$controller" "$virtual_rig"
demo
expect "a good run" $? 0
expect "order of events" "$(cat "$scratch/events")" "controller --can vcan0 --clock sync --sync-timeout 60000 --json $out/controller.json
rig --can vcan0 --clock sync --slip 0.2 --out $out --picture $out/maneuver.png
rig ended
controller ended"
expect "what the virtual rig prints" "$(cat "$scratch/stdout")" table
expect "every frame is recorded" "$(grep -c ' vcan0 080#$' "$out/bus.log")" 200
check "under its final name only" test ! -e "$out/bus.log.part"

programs "$dead_controller" "$stuck_rig"
demo
expect "the controller dies" $? 4
check "and is named" grep -q "antiskid-controller ended during the maneuver, with status 4" "$scratch/stderr"
check "the virtual rig was ended" grep -q "rig ended" "$scratch/events"

programs "$crashed_controller" "$stuck_rig"
demo
expect "the controller crashes" $? 139

programs "$controller" "$failing_rig"
demo
expect "the virtual rig fails" $? 5
check "and is named" grep -q "virtual-rig failed with status 5" "$scratch/stderr"
check "the controller was ended" grep -q "controller ended" "$scratch/events"

programs "$recorder_killer" "$stuck_rig"
demo
expect "the recorder dies" $? 137
check "and is named" grep -q "candump ended during the maneuver" "$scratch/stderr"
expect "the virtual rig was ended first, then the controller" "$(tail -n 2 "$scratch/events")" $'rig ended\ncontroller ended'

programs "$bad_end" "$virtual_rig"
demo
expect "the controller fails at its end" $? 6

programs "$controller" "$stuck_rig"
setsid env --default-signal=INT "$rig" vcan --timeout 100 -- "$here/../../firmware/host/vcan/demo" "$build" "$out" sync \
    >"$scratch/stdout" 2>"$scratch/stderr" &
run=$!
check "up" eventually 60 test -e "$scratch/rig.seen"
check "controller up" eventually 60 test -e "$scratch/events"
kill -INT $run
wait $run
expect "Ctrl-C" $? 130
expect "ends the virtual rig, then the controller" "$(tail -n 2 "$scratch/events")" $'rig ended\ncontroller ended'
check "nothing is left" eventually 5 nothing_left

# shellcheck disable=SC2317 # called by the sourced file
verb() ( # STATUS LOG OPTIONS: the verb itself; its three programs end with this status and this line in the rig's log
    set -eo pipefail
    root=$(cd "$here/../.." && pwd) ended=$1 said=$2
    say() { :; }
    setup() { :; }
    build() { :; }
    source "$root/firmware/host/vcan/demo.bash"
    demo_lockstep() { :; }
    too_late_for_real_time() { :; }
    fly() {
        touch "$2/controller.log"
        echo "$said" >"$2/virtual-rig.log"
        return "$ended"
    }
    demo "${@:3}" --out "$out" >/dev/null 2>"$scratch/stderr"
)
verb 0 ""
expect "a landing in real time" $? 0
verb 1 "virtual-rig: 1 of 9 seconds (146 periods not sent in time)"
expect "a machine that is too late after a landing in lockstep" $? 0
check "and is told" grep -q "too late for real time (146 periods)" "$scratch/stderr"
verb 1 "virtual-rig: 1 of 9 seconds (146 periods not sent in time)" --real-time
expect "one that is too late for all that was asked" $? 1
verb 1 "virtual-rig: 3 periods missed"
expect "a failure in time" $? 1
verb 3 "virtual-rig: 146 periods missed"
expect "another failure" $? 3
