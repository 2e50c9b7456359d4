#!/bin/bash
# Two at once, each with a bus of its own.
source "$(dirname "$0")/harness.bash"

run() { # MINE THEIRS: records the bus while the other sends, too
    "$rig" vcan --timeout 100 -- bash -c "
        candump -L vcan0 >$scratch/log.$1 & dump=\$!
        until grep -qs \"^ *vcan0 \" /proc/net/can/rcvlist_all; do sleep 0.05; done
        touch $scratch/up.$1
        until [[ -e $scratch/up.$2 ]]; do sleep 0.05; done
        for i in {1..50}; do cansend vcan0 $1#00; done
        touch $scratch/sent.$1
        until [[ -e $scratch/sent.$2 ]]; do sleep 0.05; done
        sleep 0.2; kill \$dump; wait \$dump"
}
run 111 222 &
first=$!
run 222 111 &
second=$!
wait $first
expect "status of the first" $? 0
wait $second
expect "status of the second" $? 0
for id in 111 222; do
    expect "bus $id carried its own 50 frames" "$(grep -c " $id#00$" "$scratch/log.$id")" 50
    expect "and no other" "$(wc -l <"$scratch/log.$id")" 50
done
check "nothing is left" eventually 5 nothing_left
