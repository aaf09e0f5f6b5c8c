#!/usr/bin/env bash
# Builds the Debian package, installs it with its dependencies into a new Debian 12, and segments the brain of the demo there.
# The system is made with debootstrap, which downloads some hundred MB from its default mirror, or from MIRROR.
# Needs root, debootstrap and dpkg-dev.
#   scripts/check_deb.sh [FOLDER]      default: a temporary folder, removed afterwards; SKIP_BUILD=1 packs the existing build
set -euo pipefail
cd "$(dirname "$0")/.."
[ "$(id -u)" = 0 ] || { echo "root is needed: a system is set up in a folder" >&2; exit 1; }
for tool in debootstrap dpkg-shlibdeps; do
  command -v "$tool" >/dev/null || { echo "$tool is missing: apt-get install debootstrap dpkg-dev" >&2; exit 1; }
done
folder=${1:-}
scratch=
[ -n "$folder" ] || scratch=$(mktemp -d)
folder=${folder:-$scratch}
mkdir -p "$folder"
root=$folder/root
tidy() {
  ! mountpoint -q "$root/proc" || umount "$root/proc"
  [ -z "$scratch" ] || rm -rf --one-file-system "$scratch"
}
trap tidy EXIT
data=/usr/share/mricron/templates

[ "${SKIP_BUILD:-0}" = 1 ] || scripts/setup.sh release pellicle >"$folder/build.log"
cpack --config build/release/CPackConfig.cmake -G DEB -B "$folder/package" >"$folder/cpack.log"
package=$(ls "$folder"/package/*.deb)
echo "--- $(basename "$package"), $(du -k "$package" | cut -f1) kB"
dpkg-deb --field "$package" Package Version Architecture Depends Description
dpkg-deb --contents "$package" | awk '!/\/$/ {print $3, $6}'

echo "--- a fresh Debian 12"
[ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$root" ${MIRROR:+"$MIRROR"} >"$folder/debootstrap.log"
cat "$root/etc/debian_version"
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc" # every running system has it
for file in resolv.conf apt/apt.conf; do [ -e "/etc/$file" ] && cp -L "/etc/$file" "$root/etc/$file"; done
in_root() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
  ${http_proxy:+http_proxy="$http_proxy"} "$@"; }
mkdir -p "$root/srv/check"
cp "$package" "$root/srv/check/pellicle.deb"
cp "$data"/ch2.nii.gz "$data"/ch2bet.nii.gz "$root/srv/check/"
in_root apt-get update -qq
in_root apt-get install -qq -y --reinstall --no-install-recommends /srv/check/pellicle.deb >"$folder/install.log" 2>&1 || { tail -20 "$folder/install.log"; exit 1; }
echo "--- installed: $(in_root dpkg-query -W -f='${Package} ${Version} ${Status}' pellicle), $(grep -c '^Setting up' "$folder/install.log") packages in all"

echo "--- runs there"
rm -rf "$root/srv/check/out"
in_root pellicle --version
in_root pellicle segment -i /srv/check/ch2.nii.gz -o /srv/check/out --preset brain-t1 --write mask,mesh,model,report,qc
in_root pellicle evaluate /srv/check/ch2bet.nii.gz /srv/check/out/ch2_mask.nii.gz
in_root pellicle report /srv/check/out -o /srv/check/out/report.html
in_root ls -1 /srv/check/out
in_root bash -c '. /usr/share/bash-completion/completions/pellicle && complete -p pellicle'
in_root sh -c 'ls /usr/share/man/man1/pellicle*.1* | wc -l; "$(ls /usr/libexec/pellicle/slicer/Pellicle)" --xml | head -2'
echo "--- goes without a trace"
in_root apt-get purge -qq -y pellicle >/dev/null 2>&1
in_root sh -c '! command -v pellicle && ! ls -d /usr/share/pellicle /usr/libexec/pellicle 2>/dev/null'
echo "done"
