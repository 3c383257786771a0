#!/usr/bin/env bash
# Whether this checkout renders the same bits as another commit: the tool of every change that must not change a picture.
#
#   benchmarks/same_bits.sh [-v] [-r REGEX] COMMIT
#
# builds COMMIT beside this checkout, renders the cases below with both, and compares every channel of the pictures. It is silent,
# with exit code 0, when all are equal; else it prints a line for each channel that differs, and the exit code is 1.
#   -v        name the cases as they pass
#   -r REGEX  only the cases whose name matches
# WAVEPATH_OTHER and WAVEPATH_THIS name executables that are built already; with WAVEPATH_OTHER no COMMIT is needed.
set -euo pipefail

# A case a line:  name | steps, separated by ';' | steps of COMMIT, only where its flags have other names
# A step is a command of wavepath. `render` renders 64x48 pixels at 4 spp into @picture.exr where the step says nothing else. @
# stands for a folder of the case's own; every .exr in it is compared, and what the step prints. The step `same A B` compares two
# files in that folder of this checkout. Scenes lie in scenes/, and those in shared/ in ../shared/scenes: where that folder is
# missing, their cases are left out. sky.hdr is a small sky.
aovs=albedo,normal,depth,position,variance,samples,direct,indirect,emission
cases() {
  cat <<END
path                    | render scenes/cornell_box.gltf --mergeable
path, all AOVs          | render scenes/showcase.glb --mergeable --aov $aovs
path, generic kernels   | render scenes/showcase.glb --specialize off --aov $aovs
path, seed              | render scenes/showcase.glb --seed 12345
path, depth 0           | render scenes/showcase.glb --max-depth 0
path, depth 1           | render scenes/showcase.glb --max-depth 1 --aov direct,indirect
path, depth 48          | render scenes/furnace_glass.gltf --max-depth 48
path, half              | render scenes/showcase.glb --half --aov $aovs
path, waves             | render scenes/showcase.glb --size 400x300 --spp 2 --mergeable
path, film bands        | render scenes/cornell_box.gltf --size 1040x1040 --spp 1 --max-depth 1
independent             | render scenes/showcase.glb --sampler independent
stratified              | render scenes/showcase.glb --sampler stratified --spp 5
uniform hemisphere      | render scenes/cornell_box.gltf --hemisphere uniform
light sampling          | render scenes/showcase.glb --direct nee
BSDF sampling           | render scenes/showcase.glb --direct bsdf
box filter              | render scenes/cornell_box.gltf --filter box
gaussian filter         | render scenes/cornell_box.gltf --filter gaussian
origin                  | render scenes/cornell_box.gltf --origin 10,-20,30
camera of one's own     | render scenes/showcase.glb --eye 3,2,4 --look-at 0,0.5,0 --up 0.1,1,0 --yfov 60
constant environment    | render scenes/furnace_metal.gltf --env 0.5,1,2
sky                     | render scenes/showcase.glb --env sky.hdr --env-intensity 0.5 --env-rotation 120 --mergeable
sky, light sampling     | render scenes/furnace_lambert.gltf --env sky.hdr --direct nee
sky, BSDF sampling      | render scenes/furnace_metal.gltf --env sky.hdr --direct bsdf
map                     | render scenes/showcase.glb --env shared/env/venice_sunset_1k.hdr
alpha mask              | render scenes/analytic/alpha_mask_cut.gltf ; render scenes/analytic/alpha_mask_kept.gltf -o @kept.exr
alpha blend             | render scenes/analytic/alpha_blend.gltf --aov $aovs
alpha, textured         | render shared/AlphaBlendModeTest/glTF-Binary/AlphaBlendModeTest.glb --aov $aovs
glass                   | render scenes/analytic/glass_slab.gltf --max-depth 16 ; render scenes/furnace_glass.gltf -o @furnace.exr
volume                  | render scenes/analytic/absorbing_glass_slab.gltf --max-depth 16
volumes, textured       | render shared/AttenuationTest/glTF-Binary/AttenuationTest.glb
transmission            | render shared/TransmissionTest/glTF-Binary/TransmissionTest.glb
mirror                  | render scenes/analytic/mirror.gltf --aov $aovs
spot light              | render scenes/analytic/spot_light.gltf
point, directional      | render scenes/analytic/point_light.gltf ; render scenes/analytic/directional_light.gltf -o @directional.exr
sphere light            | render scenes/analytic/sphere_light.gltf ; render scenes/analytic/disc_light.gltf -o @disc.exr
many lights             | render scenes/analytic/lights_of_all_sizes.gltf --spp 16
unlit                   | render scenes/analytic/unlit.gltf --aov $aovs
instances               | render shared/SimpleInstancing/glTF-Binary/SimpleInstancing.glb --aov $aovs
animation               | render shared/SimpleSkin/glTF/SimpleSkin.gltf --animation 0 --at 1.5
orthographic            | render shared/Cameras/glTF/Cameras.gltf --camera 1 --aov $aovs
Sponza                  | render shared/Sponza/Sponza.gltf --env 1,1,1 --aov $aovs
normal maps             | render shared/DamagedHelmet/glTF-Binary/DamagedHelmet.glb
lamp                    | render shared/LightsPunctualLamp/glTF/LightsPunctualLamp.gltf --aov $aovs
vertex colours          | render shared/VertexColorTest/glTF-Binary/VertexColorTest.glb
millimetres             | render shared/HotelRoom/HotelRoom-meshopt.glb
adaptive                | render scenes/showcase.glb --adaptive --spp 16 --aov $aovs
adaptive, waves         | render scenes/cornell_box.gltf --adaptive --size 320x240 --spp 4
resumed                 | render scenes/showcase.glb --spp 5 --checkpoint @state -o @5.exr ; render scenes/showcase.glb --spp 9 --checkpoint @state --resume --mergeable -o @9.exr ; render scenes/showcase.glb --spp 9 --mergeable -o @whole.exr ; same 9.exr whole.exr
resumed, AOVs           | render scenes/cornell_box.gltf --spp 5 --checkpoint @state --aov $aovs -o @5.exr ; render scenes/cornell_box.gltf --spp 8 --checkpoint @state --resume --aov $aovs -o @8.exr
merged                  | render scenes/showcase.glb --spp 8 --samples 0:3 -o @a.exr ; render scenes/showcase.glb --spp 8 --samples 3:8 -o @b.exr ; merge @b.exr @a.exr -o @joined.exr ; render scenes/showcase.glb --spp 8 --mergeable -o @whole.exr ; same joined.exr whole.exr
merged, stratified      | render scenes/cornell_box.gltf --spp 9 --sampler stratified --samples 0:4 --aov $aovs -o @a.exr ; render scenes/cornell_box.gltf --spp 9 --sampler stratified --samples 4:9 --aov $aovs -o @b.exr ; merge @a.exr @b.exr -o @joined.exr
pixel                   | render scenes/cornell_box.gltf --pixel 20,20 --sample 2 --json
pixel, sky              | render scenes/showcase.glb --env sky.hdr --pixel 31,30 --sample 3 --json
pixel, generic kernels  | render scenes/showcase.glb --specialize off --pixel 40,40 --sample 1 --seed 7 --sampler stratified
hybrid                  | render scenes/cornell_box.gltf --integrator hybrid --mergeable --aov ao
hybrid, reflections     | render scenes/showcase.glb --integrator hybrid --reflections traced -o @traced.exr ; render scenes/showcase.glb --integrator hybrid --reflections planar -o @planar.exr ; render scenes/showcase.glb --integrator hybrid --reflections ssr -o @ssr.exr ; render scenes/showcase.glb --integrator hybrid --reflections probe --shadows map -o @probe.exr
hybrid, bounce          | render scenes/cornell_box.gltf --integrator hybrid --bounce traced -o @traced.exr ; render scenes/cornell_box.gltf --integrator hybrid --bounce cones
hybrid, lens            | render scenes/showcase.glb --integrator hybrid --aperture 0.1
radiosity               | render scenes/cornell_box.gltf --integrator radiosity --patches 1024 ; render scenes/cornell_box.gltf --integrator radiosity --patches 1024 --gather -o @gathered.exr ; render scenes/cornell_box.gltf --integrator radiosity --patches 1024 --form-factors links --subdivision adaptive -o @linked.exr
velocity                | render scenes/showcase.glb --velocity 0,0,-0.5 --aov $aovs
hybrid, all AOVs        | render scenes/showcase.glb --integrator hybrid --aov $aovs,ao
hybrid, generic kernels | render scenes/showcase.glb --integrator hybrid --specialize off --aov $aovs,ao
hybrid, depth 0 and 1   | render scenes/showcase.glb --integrator hybrid --max-depth 0 ; render scenes/showcase.glb --integrator hybrid --max-depth 1 -o @1.exr
path, denoised          | render scenes/showcase.glb --integrator path --denoise --spp 5
hybrid, denoised        | render scenes/showcase.glb --integrator hybrid --denoise --spp 5 --aov ao
hybrid, many rays       | render scenes/showcase.glb --integrator hybrid --shadow-samples 4 --ao-samples 4 --sampler stratified
hybrid, waves           | render scenes/showcase.glb --integrator hybrid --size 400x300 --spp 2 --shadow-samples 4 --ao-samples 2
hybrid, film bands      | render scenes/cornell_box.gltf --integrator hybrid --size 1040x1040 --spp 1
hybrid, denoised, waves | render scenes/cornell_box.gltf --integrator hybrid --denoise --size 400x300 --spp 3
hybrid, ambient         | render scenes/showcase.glb --integrator hybrid --ambient 0.1,0.2,0.3 --ao-radius 0.5 --direct nee
hybrid, sky             | render scenes/showcase.glb --integrator hybrid --env sky.hdr --sampler independent --seed 3
hybrid, alpha           | render shared/AlphaBlendModeTest/glTF-Binary/AlphaBlendModeTest.glb --integrator hybrid --aov $aovs,ao
hybrid, instances       | render shared/SimpleInstancing/glTF-Binary/SimpleInstancing.glb --integrator hybrid --aov $aovs,ao
hybrid, orthographic    | render shared/Cameras/glTF/Cameras.gltf --camera 1 --integrator hybrid --aov $aovs,ao
hybrid, Sponza          | render shared/Sponza/Sponza.gltf --env 1,1,1 --integrator hybrid --denoise --aov ao
hybrid, resumed         | render scenes/showcase.glb --integrator hybrid --spp 5 --checkpoint @state -o @5.exr ; render scenes/showcase.glb --integrator hybrid --spp 9 --checkpoint @state --resume --mergeable -o @9.exr ; render scenes/showcase.glb --integrator hybrid --spp 9 --mergeable -o @whole.exr ; same 9.exr whole.exr
hybrid, merged          | render scenes/showcase.glb --integrator hybrid --ambient 1,1,1 --spp 8 --samples 0:3 -o @a.exr ; render scenes/showcase.glb --integrator hybrid --ambient 1,1,1 --spp 8 --samples 3:8 -o @b.exr ; merge @a.exr @b.exr -o @joined.exr
hybrid, lamp shadows    | render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows map -o @map.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows map-id -o @map-id.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows pcf -o @pcf.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows pcss -o @pcss.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows vsm -o @vsm.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows esm -o @esm.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows evsm -o @evsm.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows moment -o @moment.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows vssm -o @vssm.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows average -o @average.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows virtual -o @virtual.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows lightmap -o @lightmap.exr
hybrid, sun shadows     | render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows leak -o @leak.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows cascades -o @cascades.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows sdsm -o @sdsm.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows lispsm -o @lispsm.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows tsm -o @tsm.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows psm -o @psm.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows izb -o @izb.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows planar -o @planar.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows projected -o @projected.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --sun 30,50 --shadows zfail -o @zfail.exr
hybrid, point shadows   | render scenes/analytic/point_light.gltf --integrator hybrid --spp 2 --shadows cube -o @cube.exr ; render scenes/analytic/point_light.gltf --integrator hybrid --spp 2 --shadows paraboloid -o @paraboloid.exr
hybrid, traced maps     | render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows map --shadow-source traced -o @map.exr ; render scenes/cornell_box.gltf --integrator hybrid --spp 2 --shadows virtual --shadow-source traced -o @virtual.exr
hybrid, occlusion       | render scenes/showcase.glb --integrator hybrid --spp 2 --occlusion ssao -o @ssao.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --occlusion hbao -o @hbao.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --occlusion gtao -o @gtao.exr
hybrid, anti-aliasing   | render scenes/showcase.glb --integrator hybrid --spp 4 --antialias none -o @none.exr ; render scenes/showcase.glb --integrator hybrid --spp 4 --antialias supersample -o @supersample.exr ; render scenes/showcase.glb --integrator hybrid --spp 4 --antialias fxaa -o @fxaa.exr ; render scenes/showcase.glb --integrator hybrid --spp 4 --antialias smaa -o @smaa.exr ; render scenes/showcase.glb --integrator hybrid --spp 4 --antialias taa -o @taa.exr ; render scenes/showcase.glb --integrator hybrid --spp 4 --antialias msaa -o @msaa.exr ; render scenes/showcase.glb --integrator hybrid --spp 16 --antialias csaa -o @csaa.exr
hybrid, shading         | render scenes/showcase.glb --integrator hybrid --spp 2 --shading lambert -o @lambert.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --shading phong -o @phong.exr ; render scenes/showcase.glb --integrator hybrid --spp 2 --shading blinn-phong -o @blinn-phong.exr
hybrid, transparency    | render scenes/analytic/alpha_blend.gltf --integrator hybrid --spp 2 --transparency sorted -o @sorted.exr ; render scenes/analytic/alpha_blend.gltf --integrator hybrid --spp 2 --transparency peel -o @peel.exr ; render scenes/analytic/alpha_blend.gltf --integrator hybrid --spp 2 --transparency weighted -o @weighted.exr ; render scenes/analytic/alpha_blend.gltf --integrator hybrid --spp 2 --transparency screendoor -o @screendoor.exr ; render scenes/analytic/alpha_blend.gltf --integrator hybrid --spp 2 --transparency stochastic -o @stochastic.exr ; render scenes/analytic/glass_slab.gltf --integrator hybrid --spp 2 --transparency refractive -o @refractive.exr
ao                      | render scenes/showcase.glb --integrator ao --mergeable --aov normal,depth,ao
ao, many rays           | render scenes/analytic/occlusion_in_corner.gltf --integrator ao --ao-samples 4 --ao-radius 0.7
ao, denoised            | render shared/Sponza/Sponza.gltf --integrator ao --denoise --spp 3
END
}

fail() {
  echo "same_bits.sh: $1" >&2
  exit 2
}

usage() {
  fail "usage: same_bits.sh [-v] [-r REGEX] COMMIT"
}

clean_up() {
  git -C "$root" worktree remove --force "$work/checkout" 2>/dev/null || true
  rm -rf "$work"
}

# Builds a checkout into a folder, through its own ./run.
build() {
  local checkout=$1 folder=$2
  WAVEPATH_BUILD="$folder" "$checkout/run" --no-install --version >"$work/build.log" 2>&1 || {
    cat "$work/build.log" >&2
    fail "$checkout cannot be built; see above"
  }
}

executable() {
  [[ -x $1 ]] || fail "$1 is no executable"
  readlink -f "$1"
}

# Sets `other` and `this`, the two executables.
find_executables() {
  if [[ -n ${WAVEPATH_OTHER-} ]]; then
    other="$(executable "$WAVEPATH_OTHER")"
  else
    git -C "$root" worktree add --quiet --detach "$work/checkout" "$1"
    build "$work/checkout" "$work/build"
    other="$work/build/host/wavepath"
  fi
  if [[ -n ${WAVEPATH_THIS-} ]]; then
    this="$(executable "$WAVEPATH_THIS")"
  else
    this="${WAVEPATH_BUILD:-$root/build}/host/wavepath"
    build "$root" "${this%/host/wavepath}"
  fi
}

# Links and files that the table names, in the current folder.
provide_scenes() {
  ln -s "$root/scenes" scenes
  if [[ -d $root/../shared/scenes ]]; then ln -s "$root/../shared/scenes" shared; fi
  # 8x4 pixels, brighter towards the top, with a sun. Bytes: mantissas of R, G and B, and the exponent.
  local x y
  {
    printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n'
    for y in 0 1 2 3; do
      for x in 0 1 2 3 4 5 6 7; do
        if [[ $y$x == 12 ]]; then
          printf '\xff\xe0\xc0\x88'
        else
          printf "\\x$((90 - 20 * y))\\x$((8 - y))0\\xa$x\\x80"
        fi
      done
    done
  } >sky.hdr
}

# Runs the steps of a case with one executable, in a folder of its own; a line says what failed.
run_steps() {
  local who=$1 program=$2 name=$3 all=$4
  local folder="$who/pictures" step steps words count=0
  mkdir "$folder"
  IFS=';' read -ra steps <<<"$all"
  for step in "${steps[@]}"; do
    read -ra words <<<"${step//@/$folder/}"
    count=$((count + 1))
    if [[ ${words[0]} == same ]]; then
      [[ $who == other ]] || "$root/benchmarks/same_bits.py" --name "$name, ${words[1]} and ${words[2]}" \
        "$folder/${words[1]}" "$folder/${words[2]}" || true
      continue
    fi
    if [[ ${words[0]} == render ]]; then
      [[ $step == *" --size "* ]] || words+=(--size 64x48)
      [[ $step == *" --spp "* ]] || words+=(--spp 4)
      [[ $step == *" -o "* || $step == *" --pixel "* ]] || words+=(-o "$folder/picture.exr")
    fi
    [[ $step == *" --pixel "* ]] || words+=(-q)
    WAVEPATH_CACHE="$work/cache-$who" "$program" "${words[@]}" >"$folder/$count.txt" 2>"$who/log" || {
      echo "$name: $program fails: $(tail -n 1 "$who/log")"
      return 0
    }
    [[ -s $folder/$count.txt ]] || rm "$folder/$count.txt"
  done
}

compare_case() {
  local name=$1 steps=$2 steps_of_other=$3
  run_steps other "$other" "$name" "$steps_of_other" >other.out &
  run_steps this "$this" "$name" "$steps" >this.out
  wait $!
  cat other.out this.out
  [[ -s other.out ]] || "$root/benchmarks/same_bits.py" --name "$name" other/pictures this/pictures || true
  rm -rf other/pictures this/pictures
}

# Without the folder of shared scenes, or without a scene in it.
missing_scene() {
  local word
  for word in $1; do
    [[ $word != shared/* || -e $word ]] || echo "$word"
  done
}

run_cases() {
  local name steps steps_of_other missing passed=0 different=0 left_out=0
  while IFS='|' read -r name steps steps_of_other; do
    name="${name%"${name##*[! ]}"}" # the blanks at its end align the table
    [[ $name =~ $only ]] || continue
    missing="$(missing_scene "$steps")"
    if [[ -n $missing ]]; then
      echo "same_bits.sh: $name: left out, there is no ../shared/scenes/${missing#shared/}" >&2
      left_out=$((left_out + 1))
      continue
    fi
    compare_case "$name" "$steps" "${steps_of_other:-$steps}" </dev/null >lines
    if [[ -s lines ]]; then
      cat lines
      different=$((different + 1))
    else
      passed=$((passed + 1))
      [[ $verbose == no ]] || echo "$name: equal"
    fi
  done < <(cases)
  ((passed + different)) || fail "no case matches $only"
  [[ $verbose == no ]] || echo "$passed cases equal, $different different, $left_out left out"
  ((different == 0))
}

main() {
  verbose=no only=.
  local flag
  while getopts vr: flag; do
    case $flag in
      v) verbose=yes ;;
      r) only=$OPTARG ;;
      *) usage ;;
    esac
  done
  shift $((OPTIND - 1))
  [[ $# == 1 || ($# == 0 && -n ${WAVEPATH_OTHER-}) ]] || usage

  root="$(readlink -f "$(dirname "${BASH_SOURCE[0]}")/..")"
  work="$(mktemp -d)"
  trap clean_up EXIT
  trap 'exit 130' INT TERM
  find_executables "$@"
  cd "$work"
  mkdir other this
  provide_scenes
  run_cases
}

main "$@"
exit # bash reads a script as it goes; this one may change on disk meanwhile, as branches do
