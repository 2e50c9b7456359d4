# shellcheck shell=bash disable=SC2154,SC2164
# The verb vcan of the front door, `rig`, whose functions it uses. Its `set -e` holds here, too.

readonly guest_kernel_folder=/usr/local/lib/rig-vcan # known to `run`
guest_kernel() { # for guests, once; kept only if one starts on it
    [[ ! -x $guest_kernel_folder/linux.uml ]] || return 0
    local as_root=() said kernel
    [[ $EUID -eq 0 ]] || as_root=(sudo -n)
    if said=$("${as_root[@]}" "$root/firmware/host/vcan/fetch_kernel" "$guest_kernel_folder" 2>&1); then
        kernel=${said##*$'\n'}
        said=$("$root/firmware/host/vcan/run" --timeout 20 --kernel user-mode -- uname -r 2>&1) || true
        if [[ $said == "$kernel" ]]; then
            echo "setup: guests of ./rig vcan run on Linux $kernel from now on, in $guest_kernel_folder"
            return
        fi
        "${as_root[@]}" rm -rf "$guest_kernel_folder"
    fi
    echo "setup: no faster kernel for guests of ./rig vcan, Debian's own will do: ${said##*$'\n'}" >&2
}

vcan_help() {
    cat <<'END'
Runs a command where a real CAN interface vcan0 is up, its own for each run: in network and process namespaces where this
machine's kernel has vcan, else in a user-mode Linux guest (one virtual CPU on one core) that works on this machine's files, on the kernel
that ./rig setup fetched or on Debian's own.

  ./rig vcan [--timeout S] [--kernel auto|host|user-mode] [--disk IMAGE] [--port N] -- CMD ARGS...

  ./rig vcan -- ip -details link show vcan0
  ./rig vcan --timeout 10 -- bash -c 'candump -n 1 vcan0 & sleep 0.5; cansend vcan0 123#DEADBEEF; wait'
  ./rig vcan --port 8410 -- build/release/bin/virtual-rig serve --can vcan0 --scenario config/scenarios/heavy.toml --panel

Directory, environment, standard output and error, and exit status (128+n for signal n) are those of the command; standard
input is empty; /dev/shm is fresh; there is no other network. With --port what listens there at 127.0.0.1:N is reached here
at 127.0.0.1:N; a guest then reaches, as 10.0.2.2, what listens at 127.0.0.1 here. When the command ends, so does all that it
has started.
SIGINT, SIGTERM, SIGHUP and SIGQUIT go to the command's process group; SIGKILL follows after 5 s, a second signal ends all at
once. With --disk it is a guest, and the file IMAGE its block device /dev/ubda. In a guest the command sees itself as root, and standard
output and error are files that are copied out as they grow.

Exit status 124: timed out; 125: neither way works here, or the kernel died under the command (the message says which and why).
END
}

vcan() {
    [[ -x /usr/bin/python3 ]] || fail 125 "vcan: /usr/bin/python3 is not installed; run ./rig setup"
    exec "$root/firmware/host/vcan/run" "$@"
}
