#!/bin/bash
# Every shell script of the project, found by its first line, passes shellcheck.
set -euo pipefail
cd "$(dirname "$0")/../.."

mapfile -d '' -t files < <(
    find rig .ci config tests plant_sim firmware docs -type f -size -100k -print0 |
        while IFS= read -r -d '' file; do
            first=$(head -n 1 "$file" | tr -d '\0')
            [[ $first =~ ^#!.*sh || $first =~ ^#\ shellcheck ]] && printf '%s\0' "$file"
        done
)
[[ ${#files[@]} -gt 5 ]] || { echo "only ${#files[@]} scripts found; the search is broken" >&2; exit 1; }
shellcheck -x -P SCRIPTDIR "${files[@]}"
printf 'clean: %s\n' "${files[@]}"
