// A sky of one colour, which next-event estimation does not look for because scattered rays find it just as well. Where
// they seldom do, shadow rays go along further directions: sky_directions() a vertex, the path's own among them. Where
// training has found which parts of the sky are seen from where, the further ones are drawn by
// these, and weighed against the path's own by multiple importance sampling. Else they are drawn like it: all have the
// same density, so that each has the same weight (sky_density.glsl). Include bindings.glsl first.
#ifndef WAVEPATH_PATH_SKY_GLSL
#define WAVEPATH_PATH_SKY_GLSL

#include "kernels/base/config.glsl"

#define SAMPLES_SKY (kSky == kSkyByShadowRays) // a macro, as has() is

uint sky_directions() { return frame.sky_samples; }

// Each light sample has a queue of its own; those of the directions to the sky that are not the path's own lie behind.
uint shadow_queue_count() { return SAMPLES_SKY ? kLightSamples - 1u + sky_directions() : kLightSamples; }

#endif
