// Russian roulette within bodies that scatter and within the volume, where paths are long. The factors of shade.comp
// were not tried here.
#ifndef WAVEPATH_PATH_MEDIUM_ROULETTE_GLSL
#define WAVEPATH_PATH_MEDIUM_ROULETTE_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/base/sampler.glsl"

bool survives_medium(Sampler path_sampler, inout PathState path) {
  float survival = sqrt(max_component(path.throughput) * abs(path.eta_scale));
  if (survival < 1.0 && wave.bounce > 1u) {
    if (!(sample_2d(path_sampler, bounce_dimension(wave.bounce) + kDimensionChoice).y < survival)) return false;
    path.throughput /= survival;
  }
  return max_component(path.throughput) > 0.0;
}

#endif
