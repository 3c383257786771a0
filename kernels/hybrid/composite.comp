// A hybrid frame becomes one sample of the film: light seen directly, direct light, and the ambient term.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_FILM
#define BIND_HYBRID
#define BIND_GBUFFER
#define BIND_SIGNALS
#define BIND_SEEN
#define BIND_LAYERS
#define BIND_REFLECTIONS
#define BIND_FRACTIONS
#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_VISIBILITY
#include "kernels/base/frame_types.h"
#include "kernels/film/bindings.glsl"
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/base/camera.glsl"
#include "kernels/film/film.glsl"
#include "kernels/hybrid/fractions.glsl"
#include "kernels/hybrid/frame_terms.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/path/first_hit.glsl"
#include "kernels/base/pixel.glsl"

layout(local_size_x = kWorkgroupSize) in;

vec3 position_at(uvec2 pixel, float depth) {
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  if (uses_camera_model()) return point_at_depth(depth, origin, direction);
  return origin + direction * (depth / dot(direction, frame.camera_forward));
}

// Computes the surface AOVs that the G-buffer does not store.
void describe_surface(uvec2 pixel, uint pixel_index, inout PathAovs aovs) {
  aovs.roughness = aovs.metallic = 0.0;
  uvec2 visible = texelFetch(visibility, int(pixel_index)).xy;
  if (visible.x == kNone) return;
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  Hit hit = hit_of_triangle(visible.x, visible.y, origin, direction);
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  Bsdf b = make_bsdf(material, surface.uv, vec3(0.0), true);
  aovs.roughness = sqrt(b.alpha);
  aovs.metallic = b.metallic;
  identify(hit, surface.material, aovs);
}

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  uvec2 pixel = slot_pixel(local);
  uint pixel_index = pixel.y * frame.width + pixel.x;
  GbufferPixel g = gbuffer[pixel_index];
  vec4 signal = signals[pixel_index];
  bool hit = g.depth > 0.0;

  PathAovs sample_;
  sample_.emission = sample_.direct = vec3(0.0);
  vec3 radiance = vec3(hit ? signal.w : 0.0);
  if (wants_lights()) { // otherwise nothing has a place in `seen`
    vec4 emission_diffuse = seen[pixel_index];
    sample_.emission = emission_diffuse.rgb;
    if (hit) sample_.direct = demodulation(g.albedo) * signal.rgb;
    vec3 ambient = hit && wants_ambient() ? g.albedo * emission_diffuse.w * hybrid.ambient * signal.w : vec3(0.0);
    radiance = sample_.emission + sample_.direct + ambient;
    if ((hybrid.flags & kHybridReflections) != 0u) radiance += reflections[pixel_index].rgb;
  }
  if ((hybrid.flags & kHybridFromColor) != 0u) radiance = seen[pixel_index].rgb;
  if ((hybrid.flags & kHybridLayers) != 0u) radiance = layers[pixel_index].rgb + layers[pixel_index].a * radiance;
  uint film_index = wave.first_pixel + local - wave.first_film_pixel;
  // `seen` holds the emission until then.
  if (has(kFeatureAovs) && (hybrid.flags & kHybridFromColor) == 0u && is_finite(radiance)) {
    sample_.albedo = g.albedo;
    sample_.normal = g.normal;
    sample_.depth = g.depth;
    sample_.hit = hit ? 1.0 : 0.0;
    sample_.position = hit ? position_at(pixel, g.depth) : vec3(0.0);
    sample_.unoccluded = signal.w;
    describe_surface(pixel, pixel_index, sample_);
    FilmAovs mean = film_aovs[film_index];
    add_aovs(mean, sample_);
    film_aovs[film_index] = mean;
  }
  if ((hybrid.flags & kHybridToColor) != 0u) {
    seen[pixel_index] = vec4(radiance, 0.0);
    return;
  }
  float weight = frame_weight(pixel_index);
  radiance = weight > 0.0 ? weight * radiance : vec3(0.0);
  if (!is_finite(radiance)) return;

  uint entry = film_index * kReplicates + hybrid.sample_index % kReplicates;
  FilmPixel sums = fetch_film_pixel(entry);
  add_sample(sums, radiance);
  store_film_pixel(entry, sums);
}
