#!/bin/bash
# Every C++ file of the project is as clang-format wants it, and no comment is longer than its limit, which it leaves alone.
set -euo pipefail
cd "$(dirname "$0")/../.."

tests/front_door/lint_pinned.sh clang-format
mapfile -d '' -t files < <(find firmware plant_sim config tests rig_bridge -name '*.[ch]pp' -print0 2>/dev/null)
[[ ${#files[@]} -gt 0 ]] || { echo "no C++ file found" >&2; exit 1; }
clang-format --version
clang-format --dry-run --Werror "${files[@]}"
limit=$(sed -n 's/^ColumnLimit: //p' .clang-format)
if grep -nE "^.{$((limit + 1))}" "${files[@]}" /dev/null; then
    echo "longer than $limit columns" >&2
    exit 1
fi
echo "${#files[@]} files are clean"
