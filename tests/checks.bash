# shellcheck shell=bash disable=SC2154,SC2164
# The verb check of the front door, `rig`, whose functions it uses: campaigns that take longer than a test. Its `set -e` holds here, too.

# An emulated computer with CAN adapters, which qemu needs and nothing else.
qemu_packages=(qemu-system-x86 busybox-static)

readonly checks=(faults soak fuzz mutate mcdc pil debian qemu)

check_help() {
    cat <<'END'
Campaigns that take longer than a test, each with --help. They install and build what they need.

  ./rig check faults            every fault in every phase of a stop, against criteria; --programs, --bus: by the real programs
  ./rig check soak              maneuvers back to back by three programs over a real vcan0: does anything creep, is one lost?
  ./rig check fuzz [TARGET]     feeds the readers of frames, files and answers with what libFuzzer makes up
  ./rig check mutate            spoils firmware/control and firmware/can in 3,400 ways, one at a time: does a unit test notice?
  ./rig check mcdc              has each condition in firmware/control and firmware/can been shown to decide by itself?
  ./rig check pil               the controller on an emulated Cortex-M7: the host's bytes, instructions, memory
  ./rig check debian [12|13]    builds and tests in a clean Debian of either release, with g++ and clang++
  ./rig check qemu              an adapter pulled out of an emulated computer while braking; latency on PREEMPT_RT in virtual time
END
}

check() { # NAME ARGS
    local name=${1-}
    if [[ -z $name ]]; then
        check_help
        return
    fi
    [[ " ${checks[*]} " == *" $name "* ]] || fail 2 "check: there is no '$name'$(nearest "$name" "${checks[@]}"); see ./rig check --help"
    if is_help "${2-}"; then
        "${name}_help"
        return
    fi
    "$name" "${@:2}"
}

faults_help() {
    cat <<'END'
The fault campaign: every fault of every signal in every phase of a stop on four surfaces, 20,340 runs in process on all cores. Leaves
runs.csv, results.json and matrix.png in out/faults; docs/engineering/fault_campaign.md has catalogue and criteria. Arguments go to rig-lab faults.

  ./rig check faults
  ./rig check faults --signal wheel --kind delay
  ./rig check faults --run 4711     one run again, with its course and picture

Over a real vcan0, by the real programs, in paced lockstep (a quarter of an hour each):
  ./rig check faults --programs     controller, virtual rig and bridge killed and stopped in each phase: out/faults/programs.csv
  ./rig check faults --bus          landings while netem loses, repeats, reorders, delays and corrupts frames: out/faults/bus.csv
END
}

faults_over_the_bus() { # --programs|--bus [OPTIONS]
    local script=dead_programs out=$root/out/faults/${1#--}.csv
    [[ $1 == --programs ]] || script=disturbed_bus
    setup test >&2
    build release antiskid-controller virtual-rig rig-bridge rig-replay >&2
    mkdir -p "${out%/*}"
    cd "$root"
    exec "$root/firmware/host/vcan/run" -- /usr/bin/python3 "tests/vcan/$script.py" build/release --csv "$out" "${@:2}"
}

faults() {
    if [[ ${1-} == --programs || ${1-} == --bus ]]; then
        faults_over_the_bus "$@"
    fi
    setup product >&2
    build release rig-lab >&2
    exec "$root/build/release/bin/rig-lab" faults "$@"
}

soak_help() {
    cat <<'END'
Maneuvers back to back by controller, virtual rig and bridge over a real vcan0 and Modbus TCP. A row a minute: memory, descriptors, maneuvers,
latency. Fails when memory or descriptors grow, the stops get longer or shorter, or a maneuver is lost. Leaves soak.csv, soak.png, result.json
and the campaign (11 MB a minute) in out/soak, whose former content goes.

  ./rig check soak                              20 minutes in paced lockstep: at real time's pace, or slower where the machine is
  ./rig check soak --minutes 5 --clock timer    by the clock: a machine that is late aborts maneuvers, which are run again
  ./rig check soak --unattended                 200 maneuvers, and something befalls every tenth: a program killed or stopped, an emergency
                                                stop, a silent PLC, the clock set, frames replayed, the bus cut; ends by itself with a
                                                right ledger in out/unattended
  ./rig check soak --unattended --maneuvers 50 --every 5 --seed 2
  ./rig check soak --recovery                   each of these in each phase of a shipped scenario: recovers alone, waits for a person, or
                                                ends? Writes docs/generated/recovery.csv and docs/generated/recovery.md; an hour or two
END
}

unattended() { # ARGS: of tests/vcan/unattended.py
    rm -rf out/unattended
    "$root/firmware/host/vcan/run" -- /usr/bin/python3 tests/vcan/unattended.py build/release --out out/unattended "$@"
}

recovery() { # ARGS: of tests/vcan/recovery_table.py
    "$root/firmware/host/vcan/run" -- /usr/bin/python3 tests/vcan/recovery_table.py build/release --docs "$@"
}

soak() {
    setup test >&2
    build release antiskid-controller virtual-rig rig-bridge rig-replay soak_picture >&2
    cd "$root"
    case ${1-} in
        --unattended) unattended "${@:2}"; return ;;
        --recovery) recovery "${@:2}"; return ;;
    esac
    rm -rf out/soak
    echo "load average before: $(load_average)"
    local status=0
    "$root/firmware/host/vcan/run" -- /usr/bin/python3 tests/vcan/soak.py build/release --out out/soak "$@" || status=$?
    echo "load average after: $(load_average)"
    return $status
}

fuzz_help() {
    exec "$root/tests/fuzz/run" --help
}

fuzz() {
    setup all
    build asan fuzz_targets
    exec "$root/tests/fuzz/run" "$@"
}

mutate_help() {
    exec "$root/tests/mutation/mutate.py" --help
}

mutate() {
    setup all >&2
    exec "$root/tests/mutation/mutate.py" "$@"
}

mcdc_help() {
    exec "$root/tests/coverage/mcdc.py" --help
}

mcdc() {
    setup all clang-19 llvm-19 libclang-rt-19-dev
    build mcdc
    exec "$root/tests/coverage/mcdc.py" "$@"
}

pil_help() {
    exec "$root/firmware/cortex_m/pil" --help
}

pil() {
    setup all >&2
    build release rig-lab cortex-m-prepare >&2
    exec "$root/firmware/cortex_m/pil" "$@"
}

debian_help() {
    exec "$root/tests/debian/run" --help
}

debian() {
    [[ -x /usr/sbin/debootstrap ]] || setup product debootstrap
    exec "$root/tests/debian/run" "$@"
}

qemu_help() {
    cat <<'END'
An emulated computer with Debian's PREEMPT_RT kernel and two Kvaser PCI adapters on one CAN bus, on this machine's files. In it: an adapter
is pulled out of the braking controller and plugged in again, and latency is measured in virtual time, where what else this machine does shows
in no figure, and held against tests/qemu/latency.toml. Installs QEMU and busybox and fetches the kernel into build/qemu.

  ./rig check qemu
  ./rig check qemu -- cangen can0 -n 3      any command in it
END
}

qemu() {
    setup test "${qemu_packages[@]}" >&2
    build release antiskid-controller >&2
    cd "$root"
    compgen -G 'build/qemu/kernel/boot/vmlinuz-*' >/dev/null || tests/qemu/run --fetch >&2
    if [[ $# -gt 0 ]]; then
        exec tests/qemu/run "$@"
    fi
    say "adapter"
    tests/qemu/run -- /usr/bin/python3 tests/qemu/adapter.py build/release
    say "latency"
    tests/qemu/run --timeout 1200 -- /usr/bin/python3 tests/qemu/latency.py build/release
}
