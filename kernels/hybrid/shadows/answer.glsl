// Answers a shadow ray: the path gains a fraction of the light, and nothing is left for the ray to bring. Include
// kernels/path/records.glsl with BIND_PATHS and BIND_SHADOW_RAYS and kernels/hybrid/shadows/bindings.glsl first.
#ifndef WAVEPATH_ANSWER_GLSL
#define WAVEPATH_ANSWER_GLSL

// `lit`: fraction of the light that is not in shadow.
void answer_shadow_ray(uint index, ShadowRay ray, float lit) {
  PathState path = fetch_path(ray.slot);
  path.radiance += ray.contribution * mix(shadow.ambient, 1.0, lit);
  store_radiance(ray.slot, path);
  ray.contribution = vec3(0.0);
  ray.t_max = -1.0; // ends its walk at the root
  store_shadow_ray(index, ray);
}

#endif
