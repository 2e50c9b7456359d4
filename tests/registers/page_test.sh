#!/bin/bash
# [BRG-001] The committed page is the one that the map gives; another map gives another page.
# usage: page_test.sh [PYTHON]   from the project root
set -euo pipefail
python=${1:-/usr/bin/python3}
page=rig_bridge/registers/page.py

if ! diff <("$python" "$page" config/registers.toml) docs/user/registers.md; then
    echo "docs/user/registers.md is not what $page makes of config/registers.toml" >&2
    exit 1
fi

changed=$(mktemp)
trap 'rm -f "$changed"' EXIT
sed 's/^address = 18$/address = 20/' config/registers.toml > "$changed"
if diff -q <("$python" "$page" "$changed") docs/user/registers.md > /dev/null; then
    echo "the page does not show the map's addresses" >&2
    exit 1
fi
