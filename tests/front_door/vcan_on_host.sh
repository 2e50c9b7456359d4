#!/bin/bash
# The other way, namespaces of a kernel that has CAN: tried in a guest, whose kernel has it.
source "$(dirname "$0")/harness.bash"

mkdir "$scratch/inner"
"$rig" vcan --kernel user-mode --timeout 300 -- "$here/vcan_on_host_inside.sh" "$rig" "$scratch/inner" \
    >"$scratch/out" 2>"$scratch/err"
expect "status of all" $? 0
expect "standard output" "$(cat "$scratch/out")" "out
status 3
killed 137
timed out 124
interrupted 9
running
left: 0 processes, 0 files
port reached
taken 125
ended 143"
expect "standard error" "$(cat "$scratch/err")" "err"
check "nothing is left" eventually 5 nothing_left
