#!/bin/bash
# Every way a run can end leaves no process and no file: signal, time-out, killed parent, killed guard, dead guest.
source "$(dirname "$0")/harness.bash"

# Starts ./rig vcan on a script in the background, waits until the script says it is up. `$!` is then what a user would kill.
launch() { # SCRIPT
    : >"$scratch/out"
    setsid env --default-signal=INT "$rig" vcan --timeout 100 -- bash -c "$1" >"$scratch/out" 2>"$scratch/err" &
    run=$!
    check "up" eventually 60 has_line "$scratch/out" up
    check "and seen by the search for what is left" something_left
}

something_left() {
    ! nothing_left
}

guard() { # pid of the guard of this test's one run
    local cmdline
    for cmdline in /proc/[0-9]*/cmdline; do
        tr '\0' '\n' 2>/dev/null <"$cmdline" | grep -qx guard && grep -qsF "$TMPDIR/rig-vcan" "$cmdline" && cut -d / -f 3 <<<"$cmdline"
    done
}

loop='echo up; while :; do sleep 0.1; done'

for signal in INT TERM HUP; do
    launch "trap 'echo cleaned up; exit 9' $signal; $loop"
    kill -s $signal $run
    wait $run
    expect "SIG$signal reaches the command, which ends as it likes" $? 9
    check "and has its last word" has_line "$scratch/out" "cleaned up"
    check "nothing is left" eventually 5 nothing_left
done

# Not the loop: bash lives on when the signal meets its child at the moment that the child ends by itself.
launch "echo up; exec sleep 100"
kill -INT $run
wait $run
expect "SIGINT to a command that does not mind it" $? 130
check "nothing is left" eventually 5 nothing_left

launch "trap '' INT TERM; $loop"
kill -TERM $run
wait $run
expect "a command that ignores SIGTERM is killed" $? 137
check "nothing is left" eventually 5 nothing_left

launch "trap '' INT TERM; $loop"
while kill -INT $run 2>/dev/null; do
    sleep 0.3 # two that come too close together are one
done
wait $run
expect "a second SIGINT ends all at once" $? 130
check "nothing is left" eventually 5 nothing_left

# Long enough for the command to have its trap, however busy the machine.
"$rig" vcan --timeout 5 -- bash -c "trap 'echo cleaned up; exit 0' TERM; $loop" >"$scratch/out" 2>"$scratch/err"
expect "time-out" $? 124
check "is said" grep -q "timed out after 5 s" "$scratch/err"
check "and the command could clean up" has_line "$scratch/out" "cleaned up"
check "nothing is left" eventually 5 nothing_left

launch "$loop"
{ kill -KILL $run && wait $run; } 2>/dev/null
check "SIGKILL of the parent leaves nothing" eventually 20 nothing_left

launch "$loop"
guard=$(guard)
check "guard found" test -n "$guard"
{ kill -KILL $run "$guard" && wait $run; } 2>/dev/null
check "SIGKILL of parent and guard leaves nothing" eventually 20 nothing_left

launch "$loop"
{ kill -KILL -- -$run && wait $run; } 2>/dev/null
check "SIGKILL of the process group leaves nothing" eventually 20 nothing_left

if "$rig" vcan --kernel host -- true 2>/dev/null; then
    echo "the host's kernel has CAN; a guest is asked for to let it die"
fi
"$rig" vcan --kernel user-mode -- perl -e 'syscall(169, 0xfee1dead, 0x28121969, 0x4321fedc); sleep 100' 2>"$scratch/err"
expect "a guest that dies" $? 125
check "is said to have died" grep -q "the kernel under the command died" "$scratch/err"
check "nothing is left" eventually 5 nothing_left

# Debian's own kernel follows one that does not start on this machine.
cp -r "$here/../../firmware/host/vcan" "$scratch/vcan"
sed -i "s#^FETCHED = .*#FETCHED = \"$scratch\"#" "$scratch/vcan/run"
printf '#!/bin/sh\necho no such luck\nexit 1\n' >"$scratch/linux.uml"
chmod +x "$scratch/linux.uml"
"$scratch/vcan/run" --kernel user-mode -- sh -c 'echo ran; exit 3' >"$scratch/out" 2>"$scratch/err"
expect "a second kernel" $? 3
expect "runs the command once" "$(<"$scratch/out")" ran
check "and says why" grep -q "no such luck" "$scratch/err"
check "nothing is left" eventually 5 nothing_left
