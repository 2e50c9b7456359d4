#!/bin/bash
# Output comes through while the command runs, not at its end.
source "$(dirname "$0")/harness.bash"

# The command ends only when it sees that its first line has arrived here.
mkfifo "$scratch/pipe"
"$rig" vcan --timeout 60 -- bash -c "echo first; until [[ -e $scratch/seen ]]; do sleep 0.1; done; echo last" >"$scratch/pipe" &
exec 3<"$scratch/pipe"
read -r line <&3
expect "first line" "$line" first
touch "$scratch/seen"
read -r line <&3
expect "last line" "$line" last
wait $!
expect "status" $? 0
