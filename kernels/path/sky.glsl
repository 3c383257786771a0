// A sky of one colour, which next-event estimation does not look for because scattered rays find it just as well. Where they
// seldom do, shadow rays go along further directions drawn like theirs: `frame.sky_samples` directions a vertex, the path's
// own among them. All have the same density, so that each counts for the same share. Include bindings.glsl first.
#ifndef WAVEPATH_PATH_SKY_GLSL
#define WAVEPATH_PATH_SKY_GLSL

#include "kernels/config.glsl"

#define SHARES_SKY (kSky == kSkyByShadowRays) // a macro, as has() is

// What is left of the sky to the path's own ray, whose PathState holds `bsdf_pdf`.
float sky_share(float bsdf_pdf) { return SHARES_SKY && bsdf_pdf >= 0.0 ? 1.0 / float(frame.sky_samples) : 1.0; }

// The first is that of the first light sample; sky samples begin at the second.
uint shadow_queue_count() { return SHARES_SKY ? max(kLightSamples, frame.sky_samples) : kLightSamples; }

#endif
