# shellcheck shell=bash disable=SC2154,SC2164
# The verb bench of the front door, `rig`, whose functions it uses. Its `set -e` holds here, too.

# What is compared with, and nothing else needs.
bench_packages=(python3-sklearn)

bench_help() {
    cat <<'END'
Builds the benchmarks and runs one after the other: those in process pinned to one core, bench_sweep on all of them, those
named bench_vcan_* where a real vcan0 is up. Shows progress, leaves figures (JSON) and tables (text) in out/bench/, and ends with all tables. What runs beside
them on the machine shows in the figures: the load average is printed with each and kept in out/bench/machine.json.

  ./rig bench

Installs what is compared with, too: python3-sklearn.

Exit status 0 if all of them ran to their end; no figure is held against a limit.
END
}

run_benchmark() { # PROGRAM: in the project's root; its standard output, a table, is kept
    local core runner=()
    core=$(taskset -cp $$)
    case ${1##*/} in
        bench_vcan_*) runner=("$root/rig" vcan --) ;;
        bench_sweep) ;;
        *) runner=(taskset -c "${core##*[ ,-]}") ;;
    esac
    "${runner[@]}" "$1" | tee "out/bench/${1##*/}.txt"
}

write_machine() { # LOAD_BEFORE LOAD_AFTER
    local processor
    processor=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1)
    printf '{\n  "processor": "%s",\n  "cores": %d,\n  "kernel": "%s",\n' "$processor" "$(nproc)" "$(uname -sr)"
    printf '  "load_average_before": [%s],\n  "load_average_after": [%s]\n}\n' "${1// /, }" "${2// /, }"
}

bench() {
    setup all "${bench_packages[@]}"
    build bench
    local benchmarks program before table
    mapfile -t benchmarks < <(find "$root/build/bench" -type f -executable -name 'bench_*' | sort)
    [[ ${#benchmarks[@]} -gt 0 ]] || fail 1 "bench: no benchmark was built in build/bench"
    cd "$root"
    mkdir -p out/bench
    rm -f out/bench/*.json out/bench/bench_*.txt
    before=$(load_average)
    for program in "${benchmarks[@]}"; do
        say "${program##*/}, one of ${#benchmarks[@]}; load average $(load_average)"
        stage "${program##*/}" run_benchmark "$program" || true
    done
    write_machine "$before" "$(load_average)" >out/bench/machine.json.part
    sync out/bench/machine.json.part && mv out/bench/machine.json.part out/bench/machine.json
    say "results, in out/bench; load average before $before, after $(load_average), $(nproc) cores"
    for table in out/bench/bench_*.txt; do
        printf '\n%s\n' "$(basename "$table" .txt)"
        cat "$table"
    done
    printf '\n'
    printf '%s\n' "${summary[@]}"
    return "$failed"
}
