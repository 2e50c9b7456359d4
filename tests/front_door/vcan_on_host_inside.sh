#!/bin/bash
# Runs in a guest for vcan_on_host.sh: every promise of ./rig vcan where the kernel itself has CAN. Arguments: rig, scratch directory.
rig=$1 scratch=$2
export TMPDIR=$scratch/tmp
mkdir "$TMPDIR"

"$rig" vcan --kernel host -- bash -c 'echo out; echo err >&2; ip -brief link show vcan0 >/dev/null && exit 3'
echo "status $?"
# shellcheck disable=SC2016
"$rig" vcan -- bash -c 'kill -KILL $$'
echo "killed $?"
"$rig" vcan --timeout 0.3 -- sleep 100 2>/dev/null
echo "timed out $?"

env --default-signal=INT "$rig" vcan -- bash -c 'trap "exit 9" INT; echo up; while :; do sleep 0.1; done' >"$scratch/up" &
until grep -qs up "$scratch/up"; do sleep 0.1; done
kill -INT $!
wait $!
echo "interrupted $?"

"$rig" vcan -- bash -c 'echo up; sleep 123456' >"$scratch/up" &
until grep -qs up "$scratch/up"; do sleep 0.1; done
pgrep -f 'sleep 123456' >/dev/null && echo "running"
{ kill -KILL $! && wait $!; } 2>/dev/null # bash would report the killed job
for _ in {1..50}; do
    pgrep -f 'sleep 123456|guard' >/dev/null || [[ -n $(ls -A "$TMPDIR") ]] || break
    sleep 0.1
done
echo "left: $(pgrep -fc 'sleep 123456|guard') processes, $(find "$TMPDIR" -mindepth 1 | wc -l) files"

# shellcheck disable=SC2016
"$rig" vcan --port 8433 -- bash -c 'cd "$0" && exec /usr/bin/python3 -m http.server 8433 --bind 127.0.0.1' "$scratch" >/dev/null 2>&1 &
echo reached >"$scratch/page"
for _ in {1..100}; do
    page=$(/usr/bin/python3 -c 'import urllib.request as u; print(u.urlopen("http://127.0.0.1:8433/page").read().decode())' 2>/dev/null) && break
    sleep 0.1
done
echo "port $page"
"$rig" vcan --port 8433 -- true 2>/dev/null
echo "taken $?"
kill -TERM $!
wait $!
echo "ended $?"
