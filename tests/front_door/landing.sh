#!/bin/bash
# The choreography of ./rig demo by three programs, with stand-ins for them: who is started with what, who is asked to end when, whose
# status counts.
source "$(dirname "$0")/harness.bash"

build=$scratch/build
out=$scratch/out
mkdir -p "$build/bin"

programs() { # CONTROLLER VIRTUAL_RIG BRIDGE: bodies of the stand-ins
    local name body=("$@") programs=(antiskid-controller virtual-rig rig-bridge)
    for name in 0 1 2; do
        printf '#!/bin/bash\nout=%q\n%s\n' "$scratch" "${body[$name]}" >"$build/bin/${programs[$name]}"
        chmod +x "$build/bin/${programs[$name]}"
    done
    rm -rf "$out" "$scratch"/{events,*.seen}
    mkdir "$out"
}

landing() {
    "$rig" vcan --timeout 100 -- "$here/../../firmware/host/vcan/landing" "$build" "$out" timer scenario.toml spun-up --seed 7 \
        >"$scratch/stdout" 2>"$scratch/stderr"
}

# shellcheck disable=SC2016 # expanded in the stand-ins
{
    controller='trap "echo controller ended >>$out/events; exit 0" TERM; echo "controller $*" >>$out/events; while :; do sleep 0.1; done'
    serve='trap "echo rig ended >>$out/events; exit 0" TERM
        until grep -qs controller $out/events; do sleep 0.05; done
        echo "rig ${*%/dev/shm*}" >>$out/events; touch "${@: -1}"; while :; do sleep 0.1; done'
    dead_serve='echo "no port" >&2; exit 1'
    bridge='until grep -qs rig $out/events; do sleep 0.05; done; echo "bridge $*" >>$out/events; echo table; exit 0'
    failing='until grep -qs rig $out/events; do sleep 0.05; done; echo "bridge ended" >>$out/events; exit 1'
    killer='until grep -qs rig $out/events; do sleep 0.05; done; pkill -KILL -f bin/antiskid-controller; sleep 0.3; exit 1'
    patient='trap "echo bridge safe >>$out/events; exit 130" INT; touch $out/bridge.seen; while :; do sleep 0.1; done'
}

programs "$controller" "$serve" "$bridge"
landing
expect "a good run" $? 0
expect "order of events" "$(cat "$scratch/events")" "controller --can vcan0 --clock timer --sync-timeout 60000 --json $out/controller.json
rig serve --can vcan0 --scenario scenario.toml --clock timer --modbus 127.0.0.1:1502 --spun-up --port-file 
bridge maneuver scenario.toml --can vcan0 --plc 127.0.0.1:1502 --no-cool-down --leave-turning --picture $out/maneuver.png --out $out --seed 7
controller ended
rig ended"
expect "what the bridge prints" "$(cat "$scratch/stdout")" table

programs "$controller" "$serve" "$failing"
landing
expect "the bridge aborts" $? 1
expect "the others are ended" "$(tail -n 3 "$scratch/events")" $'bridge ended\ncontroller ended\nrig ended'

programs "$controller" "$dead_serve" "$bridge"
landing
expect "the rig does not start" $? 1
check "and says why" grep -q "no port" "$scratch/stderr"
check "the controller was ended" grep -q "controller ended" "$scratch/events"

programs "$controller" "$serve" "$killer"
landing
expect "the controller dies" $? 1
check "and is named" grep -q "antiskid-controller had ended with status 137" "$scratch/stderr"
check "the rig was ended" grep -q "rig ended" "$scratch/events"

programs "$controller" "$serve" "$patient"
setsid env --default-signal=INT "$rig" vcan --timeout 100 -- "$here/../../firmware/host/vcan/landing" "$build" "$out" timer scenario.toml at-rest \
    >"$scratch/stdout" 2>"$scratch/stderr" &
run=$!
check "up" eventually 60 test -e "$scratch/bridge.seen"
kill -INT $run
wait $run
expect "Ctrl-C" $? 130
expect "the bridge makes the rig safe before the others end" "$(tail -n 3 "$scratch/events")" $'bridge safe\ncontroller ended\nrig ended'
check "nothing is left" eventually 5 nothing_left
