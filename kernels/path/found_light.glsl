// Light that a path finds by itself. Include bindings.glsl with BIND_PATHS, and BIND_SEEN where first hits are shared,
// first.
#ifndef WAVEPATH_PATH_FOUND_LIGHT_GLSL
#define WAVEPATH_PATH_FOUND_LIGHT_GLSL

#include "kernels/base/math.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"

void add_radiance(inout PathState path, uint slot, vec3 radiance) {
  if (has(kFeatureSharedFirstHit) && wave.bounce == 0u) { // all light samples of the frame see the same
    uvec2 pixel = slot_pixel(slot);
    if (slot < wave.pixel_count) seen[pixel.y * frame.width + pixel.x] += vec4(radiance, 0.0);
    return;
  }
  path.radiance += radiance;
  if (has(kFeatureAovs)) {
    if (wave.bounce == 0u) path_aovs[slot].emission += radiance;
    if (wave.bounce == 1u) path_aovs[slot].direct += radiance;
  }
}

// True if next-event estimation might have found the light, too.
bool wants_light_weight(PathState path) { return kDirect == kDirectMis && path.bsdf_pdf >= 0.0; }

#endif
