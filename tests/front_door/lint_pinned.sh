#!/bin/bash
# lint_pinned.sh TOOL: is it the version that the project is written for? Another one formats and complains otherwise.
# Where it is not, exit status 77, by which ctest shows the test that asks as skipped; 1 on Debian 12, whose version it is.
set -euo pipefail

declare -A pinned=([clang-format]=14.0 [clang-tidy]=14.0 [cppcheck]=2.10)
version=$("$1" --version | grep -oE '[0-9]+\.[0-9]+' | head -n 1)
[[ $version != "${pinned[$1]}" ]] || exit 0
echo "skipped: $1 is version $version here; the project is written for ${pinned[$1]}, which Debian 12 has"
grep -q '^VERSION_ID="12"$' /etc/os-release && exit 1
exit 77
