#!/bin/bash
# Another lavapipe, that of Debian 13 (Mesa 25, which has ray queries): selftest, tests, pictures compared with those made here, and a picture that
# both lavapipes share.
#
#   benchmarks/other_lavapipe.sh ROOT [FOLDER]     as root
#
# ROOT holds a Debian 13, or does not exist yet: then debootstrap makes it (0.6 GB). FOLDER has Sponza, as for gpu_day.sh, whose pack
# is what runs there; it wants a build with tests. A line for each step comes to the screen, the rest to ROOT/wavepath.
# GPU_DAY_SECONDS (3000) and GPU_DAY_STEPS (info|selftest|.*_test|compare_.*) are gpu_day.sh's. Exit code 1 if a step failed.
set -euo pipefail

fail() {
  echo "other_lavapipe: error: $1" >&2
  exit 1
}

here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
[[ -n ${1:-} ]] || fail "no root is named; write other_lavapipe.sh ROOT"
[[ $(id -u) == 0 ]] || fail "only root may change the root folder; run it with sudo"
root="$(readlink -m "$1")" folder="${2:-}"
[[ $root != / ]] || fail "the root may not be this machine's own; name a folder that does not exist"
[[ ! -e $root || -x $root/usr/bin/apt-get ]] || fail "$root holds no Debian; name a folder that does not exist"

if [[ ! -e $root ]]; then
  command -v debootstrap >/dev/null || fail "there is no debootstrap; install it with apt install debootstrap"
  debootstrap --variant=minbase --include=mesa-vulkan-drivers trixie "$root.part" >"$root.log" || fail "debootstrap failed; see $root.log"
  mv "$root.part" "$root"
fi
manifest="$(cd "$root" && ls usr/share/vulkan/icd.d/lvp_icd*.json 2>/dev/null)" ||
  fail "$root has no lavapipe; install it there with chroot $root apt-get install mesa-vulkan-drivers"

work="$root/wavepath"
mkdir -p "$work"
XZ_OPT=-0 "$here/gpu_day.sh" pack "$work/pack.tar.xz" ${folder:+--assets "$folder"}
tar -xf "$work/pack.tar.xz" -C "$work"

mounted=()
leave() {
  local point
  for point in "${mounted[@]}"; do umount "$point"; done
}
trap leave EXIT
for point in proc dev; do
  mount --bind "/$point" "$root/$point"
  mounted+=("$root/$point")
done

there() { chroot "$root" env -C /wavepath -u WAVEPATH_DEVICE HOME=/root "$@"; }

failed=0
there VK_DRIVER_FILES="/$manifest" GPU_DAY_SECONDS="${GPU_DAY_SECONDS:-3000}" \
  GPU_DAY_STEPS="${GPU_DAY_STEPS:-info|selftest|.*_test|compare_.*}" wavepath-gpu-day/gpu_day.sh || failed=1

# One process with two: this machine's lavapipe beside the root's, with the libraries that the root lacks.
ours="$(find /usr/lib -name libvulkan_lvp.so -print -quit)"
[[ -n $ours ]] || fail "this machine has no lavapipe to share a picture with; install it with apt install mesa-vulkan-drivers"
system="$(dirname "$ours")"
mkdir -p "$work/ours"
cp "$ours" "$work/ours/"
for library in $(ldd "$ours" | awk '$3 ~ /^\// { print $3 }'); do
  [[ -e $root$system/$(basename "$library") ]] || cp -L "$library" "$work/ours/"
done
cat >"$work/ours/icd.json" <<END
{"file_format_version": "1.0.0", "ICD": {"library_path": "/wavepath/ours/libvulkan_lvp.so", "api_version": "1.3.0"}}
END
pack=/wavepath/wavepath-gpu-day
share() {
  there VK_DRIVER_FILES="/$manifest:/wavepath/ours/icd.json" LD_LIBRARY_PATH="$pack/lib:$system:$pack/lib/spare:/wavepath/ours" \
    "$pack/bin/wavepath" "$@"
}
picture=("$pack/scenes/cornell_box.gltf" --size 256x192 --spp 64 --integrator path --adaptive off --sky-samples 1 -q) # no pilots, as in gpu_day.sh
rm -f "$work/both.json"
share render "${picture[@]}" --devices 0,1 -o both.exr --stats both.json || failed=1
share render "${picture[@]}" --device 0 -o one.exr || failed=1
share compare both.exr one.exr --max relmse=0 || failed=1 # the bits of one
grep -E '"(bits_agree|driver|samples)"' "$work/both.json" || failed=1
exit $failed
