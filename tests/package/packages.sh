#!/bin/bash
# The Debian packages: twice the same bytes; in a bare Debian they install, land from their own files alone, keep an edited configuration
# over an upgrade, and leave nothing when purged. [DOOR-030]
# shellcheck source=tests/front_door/harness.bash
source "$(dirname "$0")/../front_door/harness.bash"

project=$(cd "$here/../.." && pwd)
debian=$scratch/debian
trap 'umount -q "$debian/proc"; rm -rf "$scratch"' EXIT

quietly() { # COMMAND...: what it says is shown where it fails
    "$@" >"$scratch/log" 2>&1 || { tail -n 30 "$scratch/log" >&2; return 1; }
}

inside() {
    chroot "$debian" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"
}

check "build" quietly "$rig" package "$scratch/first"
expect "five packages" "$(find "$scratch/first" -name '*antiskid*.deb' | wc -l)" 5
check "again" quietly "$rig" package "$scratch/second"
check "the same bytes" diff -r "$scratch/first" "$scratch/second"

# Compiling everything a second time takes as long as the first build: each commit draws eight of some fifty objects.
draw='
import hashlib, json, re, subprocess, sys
commit = subprocess.run(["git", "-C", sys.argv[1], "rev-parse", "HEAD"], capture_output=True, text=True).stdout
objects = {re.search(r" -o (\S+)", entry["command"])[1] for entry in json.load(sys.stdin)}
print(*sorted(objects, key=lambda name: hashlib.sha256(f"{commit} {name}".encode()).digest())[:8], sep="\n")'
mkdir "$scratch/elsewhere"
tar -C "$project" --exclude=./build --exclude=./out -c . | tar -C "$scratch/elsewhere" -x
check "configuration elsewhere" quietly env -C "$scratch/elsewhere" cmake --preset release -DBUILD_TESTING=OFF
mapfile -t drawn < <(/usr/bin/python3 -c "$draw" "$project" <"$scratch/elsewhere/build/release/compile_commands.json")
expect "objects drawn" ${#drawn[@]} 8
check "compiled elsewhere" quietly "$project/tests/idle.sh" ninja -C "$scratch/elsewhere/build/release" "${drawn[@]}"
for object in "${drawn[@]}"; do
    check "$object has the same bytes" cmp "$scratch/elsewhere/build/release/$object" "$project/build/release/$object"
done
rm -rf "$scratch/elsewhere"
for package in "$scratch"/first/*.deb; do
    check "no path of the builder in ${package##*/}" bash -c "! dpkg-deb --fsys-tarfile '$package' | grep -qaF '$project/'"
done

check "a bare Debian" quietly debootstrap --variant=minbase "$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)" "$debian"
cp /etc/resolv.conf "$debian/etc/resolv.conf"
mount -t proc proc "$debian/proc"
cp "$scratch"/first/*.deb "$debian/root"
check "install" quietly inside sh -c 'apt-get install -y --no-install-recommends /root/*.deb'
check "the services' configuration" test -s "$debian/etc/antiskid/controller.toml"
for program in antiskid-controller rig-bridge rig-replay virtual-rig rig-lab; do
    check "$program --help" quietly inside "$program" --help
done

# shellcheck disable=SC2016 # expanded inside
landing='cd /root
antiskid-controller --can vcan0 --clock sync --sync-timeout 60000 & controller=$!
virtual-rig --can vcan0 --clock sync --maneuver light --surface dry_asphalt --out /root/landing || exit
kill $controller; wait $controller'
check "a landing from the installed files alone" quietly "$rig" vcan --timeout 200 -- chroot "$debian" sh -c "$landing"
check "has its figures" grep -q '"finished"\|distance_m' "$debian/root/landing/result.json"
check "a study from the installed files alone" quietly inside sh -c 'cd /root && rig-lab maneuver /etc/antiskid/scenarios/ramp.toml --out ramp'

check "a stop from Python" quietly inside sh -c 'cd /root && python3 -c "import antiskid; assert antiskid.stop()[\"standstill\"]"'

sed -i 's/^period_ms = 1.0/period_ms = 2.0/' "$debian/etc/antiskid/controller.toml"
dpkg-deb -R "$scratch"/first/antiskid-config_*.deb "$scratch/newer"
sed -i 's/^Version: .*/Version: 9.0.0/' "$scratch/newer/DEBIAN/control"
echo "# newer" | tee -a "$scratch/newer/etc/antiskid/controller.toml" >>"$scratch/newer/etc/antiskid/bridge.toml"
dpkg-deb -b "$scratch/newer" "$debian/root/newer.deb" >/dev/null
check "upgrade" quietly inside dpkg --force-depends --force-confold -i /root/newer.deb
check "an edited file is kept" grep -q '^period_ms = 2.0' "$debian/etc/antiskid/controller.toml"
check "a file that was left alone is new" grep -q '^# newer' "$debian/etc/antiskid/bridge.toml"

check "purge" quietly inside apt-get purge -y antiskid-controller antiskid-bridge antiskid-lab python3-antiskid antiskid-config
rm -rf "$debian/root"
expect "what is left" "$(find "$debian" -path "$debian/proc" -prune -o -path "$debian/var/log" -prune -o -name '*antiskid*' -print)" ""
