#!/bin/bash
# The controller compiles for the target, and its objects ask for nothing but each other and the compiler's own helpers:
# no heap, no libm, no exception, no standard library code.   lint_cortex_m7.sh OBJECT_DIR
set -euo pipefail
out=$1
cd "$(dirname "$0")/../.."

flags=(-std=c++20 -O2 -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard
    -fno-exceptions -fno-rtti -fno-threadsafe-statics -ffp-contract=off -fno-math-errno
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror -I .)
rm -rf "$out"
mkdir -p "$out"
mapfile -d '' -t sources < <(find firmware/control -name '*.cpp' -print0)
[[ ${#sources[@]} -gt 0 ]] || { echo "firmware/control has no source" >&2; exit 1; }
# shellcheck disable=SC2016 # expanded by the inner shell
printf '%s\0' "${sources[@]}" | xargs -0 -P "$(nproc)" -I{} bash -c '
    source=$1 out=$2
    shift 2
    object=${source#firmware/control/}
    exec arm-none-eabi-g++ "$@" -c "$source" -o "$out/${object//\//_}.o"' compile {} "$out" "${flags[@]}"

objects=("$out"/*.o)
# memcpy and its kin are the compiler's own calls; __aeabi_* are its helpers for 64-bit integers.
allowed='^(memcpy|memmove|memset|memcmp|__aeabi_[a-z0-9]+)$'
wanted=$(arm-none-eabi-nm --undefined-only --just-symbols "${objects[@]}" | awk 'NF && !/:$/' | sort -u)
defined=$(arm-none-eabi-nm --defined-only --extern-only --just-symbols "${objects[@]}" | awk 'NF && !/:$/' | sort -u)
foreign=$(comm -23 <(echo "$wanted") <(echo "$defined") | grep -Ev "$allowed" || true)
if [[ -n $foreign ]]; then
    echo "firmware/control needs symbols that the target must not need:" >&2
    arm-none-eabi-nm -A --undefined-only "${objects[@]}" | grep -wF -- "$foreign" | arm-none-eabi-c++filt >&2
    exit 1
fi
arm-none-eabi-size -t "${objects[@]}"
