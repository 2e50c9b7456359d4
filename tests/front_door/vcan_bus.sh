#!/bin/bash
# What is up is a CAN bus: frames cross it between two processes, through can-utils and through python-can.
# shellcheck disable=SC2016 # expanded inside the guest
source "$(dirname "$0")/harness.bash"

"$rig" vcan --timeout 60 -- bash -c '
    candump -L -n 3 vcan0 & dump=$!
    until grep -qs "^ *vcan0 " /proc/net/can/rcvlist_all; do sleep 0.05; done
    cansend vcan0 123#DEADBEEF; cansend vcan0 7FF#; cansend vcan0 1F334455#R
    wait "$dump"' >"$scratch/out"
expect "status" $? 0
expect "frames as sent" "$(cut -d ' ' -f 2- "$scratch/out")" $'vcan0 123#DEADBEEF\nvcan0 7FF#\nvcan0 1F334455#R'

"$rig" vcan --timeout 60 -- /usr/bin/python3 "$here/ping.py"
expect "1000 pings through python-can came back changed as agreed" $? 0

"$rig" vcan --timeout 60 -- bash -c 'ip -brief link | grep -v LOOPBACK | wc -l' >"$scratch/out"
expect "no other interface than vcan0" "$(cat "$scratch/out")" 1
