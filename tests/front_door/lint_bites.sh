#!/bin/bash
# Each static check refuses a seeded violation and accepts the same tree without it. [DOOR-060]
source "$(dirname "$0")/harness.bash"

for tool in clang-format clang-tidy cppcheck; do
    "$here/lint_pinned.sh" "$tool" || exit
done

tree=$scratch/tree
mkdir -p "$tree"/{firmware/control,tests/front_door,config,plant_sim,docs,.ci,build}
cp "$here"/{lint_*,arrows.py,drawn.py,harness.bash,vcan_*.sh,verbs.sh} "$tree/tests/front_door"
mapfile -t parts < <(sed -n 's/^source "[$]root.\(.*\)"/\1/p' "$rig")
(cd "$(dirname "$rig")" && cp --parents rig "${parts[@]}" "$tree")
cp "$here"/../../.clang-{format,tidy} "$tree"
source=$tree/firmware/control/seeded.cpp
lints=$tree/tests/front_door
export XDG_CACHE_HOME=$scratch/cache

clean() {
    printf 'int twice(int x) {\n    return 2 * x;\n}\n' >"$source"
    cat >"$tree/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(seeded LANGUAGES CXX)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
add_subdirectory(firmware/control)
END
    cat >"$tree/firmware/control/CMakeLists.txt" <<'END'
add_library(seeded STATIC seeded.cpp other.cpp)
target_include_directories(seeded PRIVATE ${PROJECT_SOURCE_DIR})
END
    printf 'int half(int x) {\n    return x / 2;\n}\n' >"$tree/firmware/control/other.cpp"
}

refuses() { # TEXT COMMAND...
    local text=$1
    shift
    ! "$@" >"$scratch/out" 2>&1 && grep -qF -- "$text" "$scratch/out"
}

clean
check "format: clean tree" "$lints/lint_format.sh"
printf 'int twice(int x) {\n    return 2*x;\n}\n' >"$source"
check "format: spaces" refuses "code should be clang-formatted" "$lints/lint_format.sh"
clean
printf '// %0160d\n' 0 >>"$source"
check "format: a comment that is too long" refuses "longer than 150 columns" "$lints/lint_format.sh"

clean
mkdir "$scratch/newer"
for tool in clang-format clang-tidy cppcheck; do
    printf '#!/bin/sh\necho "%s version 19.1.7"\n' "$tool" >"$scratch/newer/$tool"
    chmod +x "$scratch/newer/$tool"
done
# Not skipped either: on Debian 12, where this runs, the right version is to be had.
check "format: another version" refuses "clang-format is version 19.1 here" env PATH="$scratch/newer:$PATH" "$lints/lint_format.sh"
check "tidy: another version" refuses "clang-tidy is version 19.1 here" env PATH="$scratch/newer:$PATH" "$lints/lint_tidy.py" "$tree/build"
check "misra: another version" refuses "cppcheck is version 19.1 here" env PATH="$scratch/newer:$PATH" "$lints/lint_misra.py" "$tree" "$scratch/misra"

clean
check "shell: clean tree" "$lints/lint_shell.sh"
# shellcheck disable=SC2016
printf '#!/bin/bash\nrm $1\n' >"$tree/config/seeded"
check "shell: unquoted variable" refuses SC2086 "$lints/lint_shell.sh"
rm "$tree/config/seeded"

mkdir "$tree/rig_bridge"
arrows_clean() {
    clean
    sed -i '1i #include "firmware/control/other.hpp"' "$source"
    printf 'add_library(bridge STATIC bridge.cpp)\ntarget_link_libraries(bridge PRIVATE seeded)\n' >"$tree/rig_bridge/CMakeLists.txt"
}
arrows_clean
check "arrows: clean tree" "$lints/arrows.py" "$tree"
echo '#include "rig_bridge/bridge.hpp"' >>"$source"
check "arrows: an include upwards" refuses "seeded.cpp: includes rig_bridge/bridge.hpp" "$lints/arrows.py" "$tree"
arrows_clean
echo 'target_link_libraries(seeded PRIVATE bridge)' >>"$tree/firmware/control/CMakeLists.txt"
check "arrows: a link upwards" refuses "names bridge of rig_bridge/CMakeLists.txt" "$lints/arrows.py" "$tree"
arrows_clean
touch "$tree/config/reader.cpp"
check "arrows: code in config" refuses "config/reader.cpp: config holds data alone" "$lints/arrows.py" "$tree"
rm -r "$tree/rig_bridge" "$tree/config/reader.cpp"

clean
check "tidy: clean tree" "$lints/lint_tidy.py" "$tree/build"
check "tidy: clean files are remembered" grep -q "2 files in 1 units: 1 unchanged" <<<"$("$lints/lint_tidy.py" "$tree/build")"
cat >"$tree/firmware/control/header.hpp" <<'END'
#pragma once
inline int third(const int* x) { return x == 0 ? 0 : *x / 3; }
END
printf '#include "firmware/control/header.hpp"\nint twice(int x) { return 2 * third(&x); }\n' >"$source"
check "tidy: violation in a header" refuses modernize-use-nullptr "$lints/lint_tidy.py" "$tree/build"
sed -i 's/x == 0/x == nullptr/' "$tree/firmware/control/header.hpp"
check "tidy: the header put right" "$lints/lint_tidy.py" "$tree/build"
sed -i 's/x == nullptr/x == 0/' "$tree/firmware/control/header.hpp"
check "tidy: a change in a header alone is seen" refuses modernize-use-nullptr "$lints/lint_tidy.py" "$tree/build"
clean
printf 'int seventh(int x) {\n    int y = 0;\n    return x / y;\n}\n' >"$tree/firmware/control/other.cpp"
check "tidy: what only the analyser sees, in another file of the unit" refuses clang-analyzer-core.DivideZero \
    "$lints/lint_tidy.py" "$tree/build"
printf "InheritParentConfig: true\nChecks: '-clang-analyzer-core.DivideZero'\n" >"$tree/firmware/control/.clang-tidy"
check "tidy: checks of the files' own folder are in force" "$lints/lint_tidy.py" "$tree/build"
rm "$tree/firmware/control/.clang-tidy"
# A commit whose draw takes one name in 10^9: none of these.
git -C "$tree" init -q
git -C "$tree" -c user.name=seeded -c user.email=seeded@localhost commit -q --allow-empty -m seeded
check "tidy: a unit that the commit does not draw is not followed" "$lints/lint_tidy.py" "$tree/build" --one-in 1000000000
printf 'int seventh(const int* x) { return x == 0 ? 0 : *x; }\n' >"$tree/firmware/control/other.cpp"
check "tidy: all other checks look at it" refuses modernize-use-nullptr "$lints/lint_tidy.py" "$tree/build" --one-in 1000000000

clean
check "alone: clean tree" "$lints/lint_alone.py" "$tree/build"
printf '#include <vector>\nint twice(int x) { return 2 * x; }\n' >"$source"
printf '#include <cmath>\nint half(int x) {\n    return std::vector<int>{x / 2}.front();\n}\n' >"$tree/firmware/control/other.cpp"
check "alone: a body that names what only the file before it includes" refuses "no member named 'vector'" "$lints/lint_alone.py" "$tree/build"

clean
check "target: clean tree" "$lints/lint_cortex_m7.sh" "$scratch/objects"
seeds=('float f(float x) { return std::sin(x); }' 'int* f() { return new int(3); }' 'int* f() { return (int*)std::malloc(3); }'
    'float f(float x) { return static_cast<float>(x * 2.0); }' 'int f() { throw 3; }')
texts=(sinf 'operator new' malloc double-promotion 'exception handling disabled')
for i in "${!seeds[@]}"; do
    printf '#include <cmath>\n#include <cstdlib>\n%s\n' "${seeds[i]}" >"$source"
    check "target: ${seeds[i]}" refuses "${texts[i]}" "$lints/lint_cortex_m7.sh" "$scratch/objects"
done
