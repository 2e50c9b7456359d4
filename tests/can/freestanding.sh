#!/bin/bash
# [CAN-045] What a microcontroller needs of the CAN room compiles for it, without heap, exceptions, libm or operating
# system.   freestanding.sh OBJECT_DIR
set -euo pipefail
out=$1
cd "$(dirname "$0")/../.."

flags=(-std=c++20 -O2 -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard
    -fno-exceptions -fno-rtti -fno-threadsafe-statics -ffp-contract=off
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror -Wno-psabi -I .)
sources=(controller_port controller_view e2e frame_gate observer rig_port rounded_link schedule sensor_decoder)
rm -rf "$out"
mkdir -p "$out"
for source in "${sources[@]}"; do
    arm-none-eabi-g++ "${flags[@]}" -c "firmware/can/$source.cpp" -o "$out/$source.o"
done

objects=("$out"/*.o)
# memcpy and its kin are the compiler's own calls; __aeabi_* are its helpers for 64-bit integers.
allowed='^(memcpy|memmove|memset|memcmp|__aeabi_[a-z0-9]+)$'
wanted=$(arm-none-eabi-nm --undefined-only --just-symbols "${objects[@]}" | awk 'NF && !/:$/' | sort -u)
defined=$(arm-none-eabi-nm --defined-only --extern-only --just-symbols "${objects[@]}" | awk 'NF && !/:$/' | sort -u)
foreign=$(comm -23 <(echo "$wanted") <(echo "$defined") | grep -Ev "$allowed" || true)
if [[ -n $foreign ]]; then
    echo "the CAN room needs symbols that the target must not need:" >&2
    arm-none-eabi-c++filt <<<"$foreign" >&2
    exit 1
fi
arm-none-eabi-size -t "${objects[@]}"
