// Measures the surfaces of patches: reflectance, opacity and emission, averaged over points of each.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATCHES
#include "kernels/path/bindings.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/base/records.glsl"
#include "kernels/radiosity/patches.glsl"

layout(set = 0, binding = kBindPatchSurfaces, std430) writeonly buffer PatchSurfaceBlock {
  PatchSurface patch_surfaces[];
};

layout(local_size_x = kWorkgroupSize) in;

const uint kPoints = 16u;

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint index = wave.first_pixel + gl_GlobalInvocationID.x;
  PatchSurface mean = PatchSurface(vec3(0.0), 0.0, vec3(0.0), 0u);
  Sampler points = make_replicate_sampler(frame.seed, index, 0u, 0u, kPoints);
  for (uint i = 0u; i < kPoints; ++i) {
    points.index = i;
    Hit hit = point_of_patch(index, sample_2d(points, 0u));
    Surface surface = fetch_surface(hit);
    Material material = fetch_material(surface.material);
    Vertex v = make_vertex(surface, material, -surface.geometric_normal);
    bool unlit = (material.flags & kMaterialUnlit) != 0u;
    float opaque = has(kFeatureAlpha) && !unlit
                       ? opacity(material, base_color(material, surface.uv, surface.color).a)
                       : 1.0;
    mean.opacity += opaque / float(kPoints);
    mean.reflectance += opaque / float(kPoints) * diffuse_reflectance(v);
    if (!unlit) mean.emission += opaque / float(kPoints) * surface_emission(surface, material, true);
    mean.both_sides = (material.flags & kMaterialDoubleSided) != 0u ? 1u : 0u;
  }
  if (mean.opacity > 0.0) {
    mean.reflectance /= mean.opacity;
    mean.emission /= mean.opacity;
  }
  patch_surfaces[index] = mean;
}
