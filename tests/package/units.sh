#!/bin/bash
# The systemd units are right, and expose little. [RT-120]
# shellcheck source=tests/front_door/harness.bash
source "$(dirname "$0")/../front_door/harness.bash"

build=$1
units=$scratch/units
mkdir "$units"
cp "$here"/../../firmware/host/package/*.service "$here/../../rig_bridge/bridge/rig-bridge@.service" "$units"
exposed_little() { # UNIT
    systemd-analyze security --offline=true --threshold=25 --no-pager "$1" >"$scratch/out" 2>&1
}

for unit in antiskid-controller@ antiskid-can@ rig-bridge@; do
    sed "s#/usr/bin/antiskid-controller#$build/bin/antiskid-controller#; s#/usr/bin/rig-bridge#$build/bin/rig-bridge#" \
        "$units/$unit.service" >"$scratch/$unit.service"
    expect "verify says nothing about $unit" "$(systemd-analyze verify --man=no "$scratch/$unit.service" 2>&1)" ""
    # Fails where the exposure is more than 2.5.
    check "exposure of $unit" exposed_little "$units/$unit.service"
    tail -n 1 "$scratch/out"
done
check "the controller is allowed no IP" grep -qx "IPAddressDeny=any" "$units/antiskid-controller@.service"
check "nor a socket of its families" grep -qx "RestrictAddressFamilies=AF_CAN AF_UNIX" "$units/antiskid-controller@.service"
# A seeded fault proves that the checks look.
sed -i 's/^Restart=.*/Restart=perhaps/; /^SystemCallFilter=/d; /^CapabilityBoundingSet=/d; /^AmbientCapabilities=/d; /^Protect/d; /^User=/d' "$scratch/rig-bridge@.service"
systemd-analyze verify --man=no "$scratch/rig-bridge@.service" >"$scratch/out" 2>&1
check "a wrong unit is named" grep -q "perhaps" "$scratch/out"
exposed_little "$scratch/rig-bridge@.service"
expect "an open one is refused" $? 1
