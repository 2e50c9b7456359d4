# shellcheck shell=bash disable=SC2154,SC2164
# The verb package of the front door, `rig`, whose functions it uses. Its `set -e` holds here, too.

package_help() {
    cat <<'END'
Builds the Debian packages: antiskid-controller, antiskid-bridge, antiskid-lab, python3-antiskid, and antiskid-config, which holds /etc/antiskid and the documents.
The same commit gives the same bytes.

  ./rig package [DIR]     into DIR (default out/package)

  apt install ./out/package/*.deb
  systemctl enable --now antiskid-controller@can0
END
}

package() {
    [[ $# -le 1 ]] || fail 2 "package takes one folder at most; see ./rig package --help"
    local out
    mkdir -p "${1-$root/out/package}"
    out=$(cd "${1-$root/out/package}" && pwd)
    # Every time stamp inside is the commit's; of a tree without git, the newest file's.
    SOURCE_DATE_EPOCH=$(git -C "$root" log -1 --format=%ct 2>/dev/null ||
        find "$root" -path "$root/build" -prune -o -path "$root/out" -prune -o -type f -printf '%T@\n' | sort -n | tail -n 1 | cut -d . -f 1)
    export SOURCE_DATE_EPOCH
    setup product help2man dpkg-dev file pybind11-dev python3-dev
    build release antiskid-controller rig-bridge rig-replay virtual-rig rig-lab python_module man_pages
    say "package"
    (cd "$root/build/release" && cpack -G DEB -B "$root/build/release/deb") >"$root/build/release/cpack.log" 2>&1 ||
        { cat "$root/build/release/cpack.log" >&2; return 1; }
    mv "$root"/build/release/deb/*.deb "$out"
    (cd "$out" && sha256sum ./*.deb)
}
