// With which density the vertices of sky.glsl look for the sky, and what of it that leaves to the path's own ray.
// Include bindings.glsl with BIND_LIGHTS, BIND_LIGHT_TREE and BIND_ENVIRONMENT first.
#ifndef WAVEPATH_PATH_SKY_DENSITY_GLSL
#define WAVEPATH_PATH_SKY_DENSITY_GLSL

#include "kernels/light/learned_sky.glsl"
#include "kernels/path/sky.glsl"

// True if further directions are drawn with trained probabilities.
#define USES_LEARNED_SKY (SAMPLES_SKY && uses_learned_sky())

// Directions in which a vertex looks for the sky, besides the path's own.
uint further_directions(uint bounce) { return sky_rays_at(sky_directions() - 1u, USES_LEARNED_SKY, bounce); }

// The density per solid angle of all trained directions together, given how many times more probable the part of one
// has become.
float learned_sky_pdf(uint bounce, float part_ratio) {
  return float(further_directions(bounce)) * warp_uniform_sphere_pdf() * part_ratio;
}

// The weight of the path's own ray, whose PathState holds `bsdf_pdf`, where nothing was trained.
float sky_weight(float bsdf_pdf) {
  return SAMPLES_SKY && !USES_LEARNED_SKY && bsdf_pdf >= 0.0 ? 1.0 / float(sky_directions()) : 1.0;
}

#endif
