// Mirrors of a hybrid frame: whether a surface deserves a reflection, the ray that finds it, and the fraction of light
// that the surface reflects. Include bindings.glsl with BIND_GEOMETRY, BIND_SURFACES, BIND_HYBRID and BIND_VISIBILITY,
// and reflections/bindings.glsl first.
#ifndef WAVEPATH_MIRROR_GLSL
#define WAVEPATH_MIRROR_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/surface/ray_cone.glsl"
#include "kernels/surface/vertex.glsl"

// Its random numbers are those of a bounce that hybrid paths do not have; the bounces before are taken by occlusion and
// layers. A mirror in a mirror draws those of the next one.
const uint kReflectionBounce = 3u;

struct Mirror {
  vec3 origin, direction; // of the mirrored ray
  vec3 weight;            // light that leaves the mirror for light that comes along the ray
};

// Hall's rule (Hall and Greenberg 1983): only surfaces that reflect enough, as a mirror does, are worth a ray.
bool deserves_reflection(Bsdf b, Interface boundary) {
  vec3 head_on = mix(boundary.f0, b.base_color, b.metallic);
  return b.alpha < kMirrorRoughness * kMirrorRoughness && max_component(head_on) >= reflection.threshold;
}

// False if the vertex is no mirror. `facet`: numbers that pick one of the mirror's facets, where it is not quite
// smooth; `draws`: false = all are taken to lie in the surface.
bool mirror_at(Vertex v, vec2 facet, bool draws, out Mirror mirror) {
  Interface boundary = surface_of(v.bsdf);
  vec3 wo = to_local(v, v.wo);
  if (!(wo.z > 0.0) || !deserves_reflection(v.bsdf, boundary)) return false;
  bool rough = draws && !is_mirror(v.bsdf);
  vec3 h = rough ? sample_facet(v.bsdf, wo, facet) : vec3(0.0, 0.0, 1.0);
  float c = dot(wo, h);
  vec3 wi = 2.0 * c * h - wo;
  if (!(wi.z > 0.0)) return false;
  mirror.weight = facet_reflectance(v.bsdf, boundary, c);
  if (rough)
    mirror.weight *= facet_distribution(v.bsdf, h) * facet_visibility(v.bsdf, wo, wi) * wi.z /
                     max(facet_reflected_pdf(v.bsdf, wo, h), 1e-30);
  mirror.direction = normalize(to_world(wi, v.tangent, v.bitangent, v.normal));
  if (!sides_agree(v, mirror.direction)) return false;
  mirror.origin = offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal,
                                    mirror.direction);
  return true;
}

// The mirror that a pixel shows; false if there is none.
bool find_mirror(uvec2 pixel, vec2 facet, bool draws, out Mirror mirror) {
  uvec2 visible = texelFetch(visibility, int(pixel.y * frame.width + pixel.x)).xy;
  if (visible.x == kNone) return false;
  vec3 eye, towards;
  hybrid_camera_ray(pixel, eye, towards);
  Hit hit = hit_of_triangle(visible.x, visible.y, eye, towards);
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  if ((material.flags & kMaterialUnlit) != 0u) return false;
  open_cone(hit, surface.position - eye);
  Vertex v = make_vertex(surface, material, towards);
  close_cone();
  return mirror_at(v, facet, draws, mirror);
}

#endif
