#!/bin/bash
# What is worth knowing of a GPU, in ten minutes, on a machine that has its driver and nothing else.
#
#   benchmarks/gpu_day.sh pack FILE.tar.xz [--assets FOLDER]   here: program, libraries, tests, scenes, pictures of this device
#   tar -xf FILE.tar.xz && wavepath-gpu-day/gpu_day.sh         there: selftest, tests, renders, benches
#
# FOLDER has Sponza and DamagedHelmet; without it, scenes of this repository stand in. `pack` wants a build with tests (./run test does
# one; WAVEPATH_BUILD names another folder than ./build). There, results go to ./results: a line for each step in steps.jsonl and on
# the screen, documents and logs beside it. GPU_DAY_SECONDS bounds the whole (590); more stretches each step's limit as well. GPU_DAY_STEPS,
# a regular expression, chooses steps by name. Exit code 1 if a step failed.
set -euo pipefail

here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"

fail() {
  echo "gpu_day: error: $1" >&2
  exit 1
}

# ---- pack -----------------------------------------------------------------------------------------------------------

# Of those that need no file of the source tree but the packed scenes: what a compiler or a memory model may break.
tests=(math sampler bsdf bsdf_chi_square layers light_sampling light_tree_walk kernels traverse image raster texel_pages ray_query)
# No pilots: rounding may tip what they decide.
reference_flags=(--size 480x270 --spp 64 --max-depth 5 --integrator path --seed 7 --adaptive off --sky-samples 1)

# Libraries that drivers load as well: the machine's own come first, because a newer driver needs newer ones.
drivers_too='/lib(stdc\+\+|gcc_s|z|X[^/]*|xcb|bsd|md|vulkan)\.so'

# The libraries of programs, but for the C library, whose loader must be its own, and the dynamic linker.
libraries_of() {
  ldd "$@" | awk '$2 == "=>" && $3 ~ /^\// { print $3 }' | sort -u |
    grep -vE '/(libc|libm|libdl|libpthread|librt|ld-linux[^/]*)\.so'
}

pack() {
  local file="${1:-}" assets=""
  [[ -n $file ]] || fail "pack: no file is named; write gpu_day.sh pack FILE.tar.xz"
  [[ ${2:-} == --assets ]] && assets="${3:-}"
  local root build top stage
  root="$(dirname "$here")"
  build="${WAVEPATH_BUILD:-$root/build}"
  [[ -x $build/host/wavepath ]] || fail "pack: there is no $build/host/wavepath; build it with ./run test first"
  top="$(mktemp -d)"
  # shellcheck disable=SC2064
  trap "rm -rf '$top'" EXIT # now: it is unknown at the end
  stage="$top/wavepath-gpu-day"
  mkdir -p "$stage"/{bin,lib/spare,tests,layers,scenes,references}
  cp "$here/gpu_day.sh" "$stage/"
  strip -o "$stage/bin/wavepath" "$build/host/wavepath"
  local name
  for name in "${tests[@]}"; do
    [[ -x $build/tests/${name}_test ]] || fail "pack: there is no $build/tests/${name}_test; build it with ./run test first"
    strip -o "$stage/tests/${name}_test" "$build/tests/${name}_test"
  done
  local layer=/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json
  if [[ -f $layer ]]; then
    local library
    library="$(find /usr/lib -name libVkLayer_khronos_validation.so -print -quit)"
    strip -o "$stage/layers/libVkLayer_khronos_validation.so" "$library"
    sed 's|"library_path": *"[^"]*"|"library_path": "./libVkLayer_khronos_validation.so"|' "$layer" \
      >"$stage/layers/VkLayer_khronos_validation.json"
  fi
  local library
  for library in $(libraries_of "$stage/bin/wavepath" "$stage"/tests/* "$stage"/layers/*.so); do
    if [[ $library =~ $drivers_too ]]; then cp -L "$library" "$stage/lib/spare/"; else cp -L "$library" "$stage/lib/"; fi
  done

  cp "$root/scenes/cornell_box.gltf" "$root/scenes/showcase.glb" "$stage/scenes/"
  cp "$root"/scenes/cornell_box*.bin "$stage/scenes/" 2>/dev/null || true
  if [[ -d $assets/Sponza ]]; then
    cp -r "$assets/Sponza" "$stage/scenes/"
  elif [[ -n $assets ]]; then
    fail "pack: $assets has no Sponza; name the folder above it"
  fi
  local scene
  for scene in $(scenes_in "$stage"); do
    # shellcheck disable=SC2046
    "$stage/bin/wavepath" render "$scene" $(flags_of "$scene") "${reference_flags[@]}" -q \
      -o "$stage/references/$(basename "${scene%.*}").exr"
  done
  (cd "$root" && git rev-parse --short HEAD) >"$stage/commit" 2>/dev/null || echo unknown >"$stage/commit"
  tar -cJf "$file.part" -C "$top" wavepath-gpu-day
  mv "$file.part" "$file"
  echo "gpu_day: $file: $(($(stat -c %s "$file") / 1048576)) MiB, $(find "$stage" -type f | wc -l) files"
}

# ---- run ------------------------------------------------------------------------------------------------------------

scenes_in() { find "$1/scenes" -name '*.gltf' -o -name '*.glb' | sort; }

flags_of() {
  [[ $1 != *Sponza* ]] || echo "--env 1,1,1 --eye 4,1.8,0.2 --look-at -10,2.2,-0.3 --yfov 65"
}

began=$SECONDS
failed=0

# step NAME SECONDS COMMAND...: within its own limit and what is left of the whole.
step() {
  local name=$1 limit=$2 code=0 whole="${GPU_DAY_SECONDS:-590}"
  shift 2
  [[ $name =~ ^(${GPU_DAY_STEPS:-.*})$ ]] || return 0
  ((whole <= 590)) || limit=$((limit * whole / 590))
  local left=$((whole - SECONDS + began))
  if ((left < 5)); then
    echo "{\"step\": \"$name\", \"code\": null, \"why\": \"no time left\"}" | tee -a "$results/steps.jsonl"
    return
  fi
  local start=$SECONDS
  timeout -k 5 $((left < limit ? left : limit)) "$@" >"$results/$name.log" 2>&1 || code=$?
  echo "{\"step\": \"$name\", \"code\": $code, \"seconds\": $((SECONDS - start))}" | tee -a "$results/steps.jsonl"
  ((code == 0)) && return
  failed=1
  tail -n 15 "$results/$name.log" | sed 's/^/    /'
}

# A render of the packing device's samples on this one: the same but for rounding, so an error far below the noise.
compare_with_reference() {
  local scene=$1 name=$2 results=$3
  # shellcheck disable=SC2046
  "$here/bin/wavepath" render "$scene" $(flags_of "$scene") "${reference_flags[@]}" -q -o "$results/compare_$name.exr"
  "$here/bin/wavepath" compare "$results/compare_$name.exr" "$here/references/$name.exr" --json | tee "$results/compare_$name.json"
  awk -F'[:,]' '/"relmse"/ { found = 1; exit !($2 < 1e-3) } END { if (!found) exit 1 }' "$results/compare_$name.json"
}

run() {
  results="$PWD/results"
  mkdir -p "$results"
  : >"$results/steps.jsonl"
  local system
  system="$(PATH="$PATH:/usr/sbin:/sbin" ldconfig -p | sed -n 's|.* => \(/.*\)/[^/]*$|\1|p' | sort -u | paste -sd:)" || system=""
  export LD_LIBRARY_PATH="$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}${system:+:$system}:$here/lib/spare"
  export XDG_CACHE_HOME="$results/cache"
  # Where containers have NVIDIA's driver, the loader does not look.
  local nvidia=/usr/local/nvidia/share/vulkan/icd.d/nvidia_icd.json
  [[ -n ${VK_DRIVER_FILES:-} || ! -f $nvidia ]] || export VK_DRIVER_FILES=$nvidia
  local program="$here/bin/wavepath" scene name flags
  nvidia-smi -q -d CLOCK,MEMORY >"$results/nvidia-smi.txt" 2>&1 || true

  step info 20 sh -c "'$program' info && '$program' info --json >'$results/info.json'"
  step selftest 120 sh -c "'$program' selftest --json >'$results/selftest.json'"
  for name in "$here"/tests/*_test; do
    step "$(basename "$name")" 90 env WAVEPATH_REQUIRE_VULKAN=1 WAVEPATH_SCENES="$here/scenes" "$name"
  done
  if [[ -d $here/layers ]]; then
    step validation 40 env WAVEPATH_VALIDATION=1 VK_LAYER_PATH="$here/layers" "$program" render \
      "$here/scenes/cornell_box.gltf" --size 256x256 --spp 16 -o "$results/validation.exr"
  fi
  for scene in $(scenes_in "$here"); do
    name="$(basename "${scene%.*}")" flags="$(flags_of "$scene")"
    step "compare_$name" 60 bash "$here/gpu_day.sh" compare "$scene" "$name" "$results" # `timeout` starts no functions
    # shellcheck disable=SC2086
    step "bench_$name" 90 "$program" bench "$scene" $flags --json "$results/bench_$name.json" -q
    # shellcheck disable=SC2086
    step "render_$name" 40 "$program" render "$scene" $flags --size 1920x1080 --spp 256 --time 20 --integrator path -q \
      -o "$results/render_$name.png" --stats "$results/render_$name.json"
    # shellcheck disable=SC2086
    step "hybrid_$name" 30 "$program" render "$scene" $flags --size 1920x1080 --spp 16 --time 10 --integrator hybrid -q \
      -o "$results/hybrid_$name.png" --stats "$results/hybrid_$name.json"
  done
  rm -f "$results"/compare_*.exr "$results/validation.exr"
  [[ -s $results/steps.jsonl ]] || fail "no step is called ${GPU_DAY_STEPS:-}; see the first lines of the script"
  echo "gpu_day: commit $(cat "$here/commit"), $((SECONDS - began)) s, results in $results"
  return $failed
}

case "${1:-}" in
  pack) shift && pack "$@" ;;
  compare) shift && compare_with_reference "$@" ;; # a step of run()
  "") [[ -f $here/commit ]] || fail "this is no unpacked pack; see the first lines of the script" && run ;;
  *) fail "unknown command $1; see the first lines of the script" ;;
esac
