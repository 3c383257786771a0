// What is seen through the nearest transmitting surface, from the opaque picture alone: the ray is bent where it enters
// a body and where it leaves it, whose position the picture of the next surface behind tells (after Wyman 2005); then
// it goes on to the depth that the opaque picture has where it arrives. Beyond the picture's rim, and where it is
// empty, is the environment.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GBUFFER
#define BIND_SEEN
#include "kernels/hybrid/transparency/found_layer.glsl"
#include "kernels/path/bindings.glsl"

const uint kDepthSteps = 8u;    // until a ray has found where it meets the picture
const uint kExitSteps = 3u;      // until a ray has found where it leaves a body
const float kFarAlong = 1.0e5f; // metres: where a ray is taken to be gone

// Where the frame shows a point, in pixels, and its depth.
vec2 shown_at(vec3 p, out float depth) {
  vec3 offset = p - frame.camera_position;
  depth = dot(offset, frame.camera_forward);
  vec2 xy = vec2(dot(offset, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                 -dot(offset, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
  if (!is_orthographic()) xy /= max(depth, 1e-30);
  return 0.5 * (xy + 1.0) * vec2(frame.width, frame.height) - hybrid.jitter;
}

bool in_picture(vec2 at, float depth) {
  return depth > 0.0 && all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(frame.width, frame.height)));
}
uint index_of(vec2 at) { return uint(at.y) * frame.width + uint(at.x); }

// Radiance along a ray, and how far away it comes from.
vec3 seen_along(vec3 origin, vec3 direction, out float along) {
  float facing = dot(direction, frame.camera_forward),
        start = dot(origin - frame.camera_position, frame.camera_forward), pdf;
  float depth;
  vec2 at = shown_at(origin, depth);
  along = kFarAlong;
  if (facing > 0.0 && in_picture(at, depth) && gbuffer[index_of(at)].depth > 0.0)
    along = max((gbuffer[index_of(at)].depth - start) / facing, 0.0);
  for (uint step_ = 0u; step_ < kDepthSteps && facing > 0.0; ++step_) {
    at = shown_at(origin + along * direction, depth);
    if (!in_picture(at, depth) || gbuffer[index_of(at)].depth == 0.0) break;
    along = max((gbuffer[index_of(at)].depth - start) / facing, 0.0);
    if (step_ + 1u == kDepthSteps) return seen[index_of(at)].rgb;
  }
  along = kFarAlong;
  return environment_emission(direction, pdf);
}

Surface next_surface(uvec2 pixel) {
  uvec2 placed = texelFetch(layer_triangles, int(texelFetch(layer_seen, int(pixel.y * frame.width + pixel.x)).x)).xy;
  vec3 eye, towards;
  hybrid_camera_ray(pixel, eye, towards);
  return fetch_surface(hit_of_triangle(placed.x, placed.y, eye, towards));
}

// A ray inside a body leaves it where it meets the plane of the surface that comes next behind the pixel; then of that
// behind the pixel where it got to, for bodies that are round. What it meets nowhere near is as far away as straight
// behind.
void leave_body(uvec2 pixel, Vertex entry, inout vec3 origin, inout vec3 direction, inout vec3 weight) {
  Surface surface;
  float deep = 0.0;
  for (uint step_ = 0u; step_ < kExitSteps; ++step_) {
    surface = next_surface(pixel);
    vec3 n = surface.geometric_normal;
    float straight = distance(origin, surface.position), along = dot(n, surface.position - origin) / dot(n, direction);
    deep = along > 0.0 && along < 4.0 * straight ? along : straight;
    float depth;
    vec2 at = shown_at(origin + deep * direction, depth);
    if (in_picture(at, depth) && texelFetch(layer_seen, int(index_of(at))).x != kNone) pixel = uvec2(at);
  }
  origin += deep * direction;
  weight *= exp(-entry.material.attenuation * deep);
  vec3 normal = shading_normal(surface, fetch_material(surface.material),
                               dot(surface.geometric_normal, direction) <= 0.0, -direction);
  Interface inside = make_interface(entry.bsdf.ior, entry.bsdf.specular_color, entry.bsdf.specular, false);
  float c = dot(-direction, normal);
  vec3 outside;
  if (!(c > 0.0) || !refract_direction(-direction, normal, inside.eta, outside)) return; // total reflection is left out
  weight *= 1.0 - max_component(fresnel_dielectric(inside, c));
  direction = outside;
}

vec3 refracted(uint first, uint pixel_index) {
  uvec2 pixel = uvec2(pixel_index % frame.width, pixel_index / frame.width),
        placed = texelFetch(layer_triangles, int(first)).xy;
  vec3 eye, towards;
  hybrid_camera_ray(pixel, eye, towards);
  Hit hit = hit_of_triangle(placed.x, placed.y, eye, towards);
  vec3 light = layer_light(hit, pixel, eye, towards).rgb;
  Surface surface = fetch_surface(hit);
  Vertex v = make_vertex(surface, fetch_material(surface.material), towards);
  vec3 wo = to_local(v, v.wo);
  Lobes l = lobes_of(v.bsdf, wo);
  vec3 mirror = vec3(0.0, 0.0, 1.0), facet = mirror;
  if (!l.delta_reflection)
    facet = sample_facet(v.bsdf, wo,
                         sample_2d(hybrid_sampler(pixel), bounce_dimension(kLayerBounce) + kDimensionDirection));
  float along;
  if (l.delta_reflection) {
    vec3 reflected = 2.0 * dot(wo, mirror) * mirror - wo;
    light += facet_reflectance(v.bsdf, l.surface, wo.z) *
             seen_along(surface.position, to_world(reflected, v.tangent, v.bitangent, v.normal), along);
  }
  vec3 h = l.delta_transmission ? mirror : facet, bent;
  float c = dot(wo, h);
  vec3 weight = facet_transmittance(v.bsdf, l.surface, c);
  if (v.bsdf.thin) {
    vec3 mirrored = 2.0 * c * h - wo;
    bent = l.delta_transmission ? -wo : vec3(mirrored.xy, -mirrored.z);
  } else if (!refract_direction(wo, h, l.surface.eta, bent)) {
    return light;
  }
  vec3 origin = surface.position, direction = to_world(bent, v.tangent, v.bitangent, v.normal);
  bool leaves = !v.bsdf.thin && texelFetch(layer_seen, int(pixel_index)).x != kNone;
  if (leaves) leave_body(pixel, v, origin, direction, weight);
  vec3 beyond = seen_along(origin, direction, along);
  if (!v.bsdf.thin && !leaves) weight *= exp(-v.material.attenuation * along); // water has no other side
  return light + weight * beyond;
}

// The first pass leaves the index of its layer, in two halves that floats hold exactly.
void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  if (wave.bounce == 0u) {
    uint layer = texelFetch(layer_seen, int(pixel_index)).x;
    layers[pixel_index] = layer == kNone ? vec4(-1.0) : vec4(layer & 0xffffu, layer >> 16, 0.0, 0.0);
    return;
  }
  vec2 first = layers[pixel_index].xy;
  if (first.x < 0.0) {
    layers[pixel_index] = vec4(0.0, 0.0, 0.0, 1.0);
    return;
  }
  vec3 light = refracted(uint(first.x) | uint(first.y) << 16, pixel_index);
  layers[pixel_index] = vec4(is_finite(light) ? light : vec3(0.0), 0.0);
}
