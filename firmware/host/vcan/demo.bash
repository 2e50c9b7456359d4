# shellcheck shell=bash disable=SC2154,SC2164
# The verb demo of the front door, `rig`, whose functions it uses. Its `set -e` holds here, too.

demo_help() {
    cat <<'END'
A heavy landing on dry asphalt over a real CAN interface: first antiskid-controller and virtual-rig in lockstep, as fast as both can; then, where
this machine wakes programs up in time, antiskid-controller, virtual-rig (the rig and its PLC) and rig-bridge (which runs the maneuver, over
Modbus TCP) in real time. Shows a table of each; leaves bus.log, trajectory.csv, result.json, controller.json and maneuver.png in out/demo, and
of the three programs bus.log, modbus.csv, summary.json, controller.json and maneuver.png in out/demo/real_time. Exit status 0 if the first
landing is good and this machine is too late for the second; the rig is then safe, which --real-time alone reports with 1.

  ./rig demo
  ./rig demo --lockstep --surface snow --slip 0.1   the first alone: another landing
  ./rig demo --paced                                the three programs alone, in lockstep and never faster than real time: a slow machine
                                                    stretches time instead of missing deadlines
  ./rig demo --real-time --spin-up                  the three programs alone, however late this machine is, from a flywheel at rest (72 s more)
  ./rig demo --scenario rejected_takeoff            another file of config/scenarios by the three programs

  --out DIR              where the files go (default out/demo); earlier ones of these names are replaced
  --seed N               of every random draw
  --maneuver M, --surface S, --slip X, --law L      with --lockstep, as virtual-rig takes them
  --scenario NAME|FILE   of the three programs: config/scenarios/NAME.toml (default heavy)
  --spin-up              of the three programs: the flywheel starts at rest, not at the landing's speed
END
}

readonly demo_options=(--lockstep --paced --real-time --scenario --spin-up --maneuver --surface --slip --law --seed --out)

demo_lockstep() {
    local maneuver=heavy surface=dry_asphalt slip=0.24 law=slip out=out/demo more=()
    while [[ $# -gt 0 ]]; do
        if [[ $1 == --lockstep ]]; then
            shift
            continue
        fi
        [[ $1 =~ ^--(maneuver|surface|slip|law|seed|out)$ ]] ||
            fail 2 "demo: unknown option '$1'$(nearest "$1" "${demo_options[@]}"); see ./rig demo --help"
        [[ $# -ge 2 ]] || fail 2 "demo: $1 needs a value; see ./rig demo --help"
        case $1 in
            --maneuver) maneuver=$2 ;;
            --surface) surface=$2 ;;
            --slip) slip=$2 ;;
            --law) law=$2 ;;
            --seed) more=(--seed "$2") ;;
            --out) out=$2 ;;
        esac
        shift 2
    done
    setup product
    build release antiskid-controller virtual-rig rig-bridge
    mkdir -p "$out"
    out=$(cd "$out" && pwd)
    say "demo: $maneuver landing on $surface, law $law, slip reference $slip, lockstep"
    # Should this script be killed, so is the run.
    setpriv --pdeathsig TERM "$root/firmware/host/vcan/run" -- "$root/firmware/host/vcan/demo" "$root/build/release" "$out" sync \
        --maneuver "$maneuver" --surface "$surface" --slip "$slip" --law "$law" "${more[@]}"
    printf '\nWritten to %s: %s\n' "$out" "$(cd "$out" && echo *)"
}

fly() { # timer|sync OUT: one landing by three programs; $scenario, $spin_up, $view and ${more[@]} are the caller's
    say "demo: $(basename "$scenario" .toml) by controller, virtual rig and bridge, clock $1"
    rm -f "$2"/{bus.log,modbus.csv,summary.json,controller.json,controller.log,virtual-rig.log,maneuver.png,trajectory.csv,result.json}
    # Should this script be killed, so is the run.
    setpriv --pdeathsig TERM "$root/firmware/host/vcan/run" -- "$root/firmware/host/vcan/landing" \
        "$root/build/release" "$2" "$1" "$scenario" "$spin_up" --view "$view" "${more[@]}"
}

# Why this machine cannot do real time, by 2,000 wake-ups of the controller's own pacer where vcan0 is; nothing where it can. One in a hundred may
# be missed; none may come after 10 ms, half of the time after which the controller gives up a sensor.
too_late_for_real_time() {
    local check=("$root/build/release/bin/antiskid-controller" --can vcan0 --check --timing-s 2 --json -)
    { "$root/firmware/host/vcan/run" -- "${check[@]}" 2>/dev/null || true; } |
        /usr/bin/python3 -c 'import json, sys
checks = {check["name"]: check for check in json.JSONDecoder().raw_decode(sys.stdin.read())[0]["checks"]}
missed, latest_us = int(checks["missed periods"]["measured"].split()[0]), checks["loop latency"]["figures"]["max_us"]
if missed > 20 or latest_us > 10000.0:
    print(f"{missed} of 2,000 periods missed, the latest wake-up after {latest_us / 1000.0:.1f} ms")' 2>/dev/null ||
        echo "its wake-ups could not be timed"
}

demo_both() { # OPTIONS
    demo_lockstep "$@"
    local late
    late=$(too_late_for_real_time)
    if [[ -n $late ]]; then
        say "demo: real time is left out, this machine is too late for it now: $late
   ./rig demo --paced shows the three programs on stretched time, ./rig demo --real-time all the same"
        return
    fi
    local landed=1
    demo_landing --real-time "$@"
}

demo_landing() {
    local scenario=heavy out=out/demo clock=timer more=() view=plain status=0 late spin_up=spun-up
    while [[ $# -gt 0 ]]; do
        case $1 in
            --paced) clock=sync ;;
            --real-time) clock=timer ;;
            --spin-up) spin_up=at-rest ;;
            --scenario | --seed | --out)
                [[ $# -ge 2 ]] || fail 2 "demo: $1 needs a value; see ./rig demo --help"
                case $1 in
                    --scenario) scenario=$2 ;;
                    --seed) more=(--seed "$2") ;;
                    --out) out=$2 ;;
                esac
                shift
                ;;
            *) fail 2 "demo: unknown option '$1'$(nearest "$1" "${demo_options[@]}"); see ./rig demo --help" ;;
        esac
        shift
    done
    [[ $scenario == */* || $scenario == *.toml ]] || scenario=$root/config/scenarios/$scenario.toml
    [[ -f $scenario ]] || fail 2 "demo: there is no scenario $scenario; see config/scenarios"
    scenario=$(cd "$(dirname "$scenario")" && pwd)/$(basename "$scenario")
    setup product
    build release antiskid-controller virtual-rig rig-bridge
    mkdir -p "$out/real_time"
    out=$(cd "$out/real_time" && pwd)
    # Inside a guest nothing is a terminal; what it writes comes out on this one.
    if [[ -t 2 ]]; then
        view=live
        COLUMNS=$(tput cols 2>/dev/null || echo 100)
        export COLUMNS
    fi
    cd "$root"
    fly "$clock" "$out" || status=$?
    if [[ $status -ne 0 ]]; then
        # By their own words, since what a late program makes the controller name depends on which one it was: overrun, or sensors lost.
        late=$(cat "$out"/{virtual-rig,controller}.log | sed -nE 's/.*[ (]([0-9]+) periods (not sent in time|missed).*/\1/p' | sort -n | tail -n 1)
        if [[ $status -eq 1 && $clock == timer && ${late:-0} -gt 20 ]]; then
            echo "demo: this machine was too late for real time ($late periods), and the rig is safe; ./rig demo --paced stretches time instead" >&2
            # After a landing in lockstep that is the machine's limit, as if the wake-ups had shown it before.
            [[ -z ${landed-} ]] || status=0
        fi
        echo "demo: what each program said is in $out" >&2
        return "$status"
    fi
    printf '\nWritten to %s: %s\n' "$out" "$(cd "$out" && echo *)"
}

demo() {
    local option which=demo_both
    for option in "$@"; do
        case $option in
            --lockstep | --maneuver | --surface | --slip | --law) which=demo_lockstep ;;
            --paced | --real-time | --scenario | --spin-up) which=demo_landing ;;
        esac
    done
    "$which" "$@"
}
