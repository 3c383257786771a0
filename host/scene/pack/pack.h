// From Scene to the arrays that the kernels read: geometry in BVH leaf order around an origin near the eye, lights with
// their alias table, texels, and the features that this scene needs. No Vulkan; every array can be tested on its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "bvh/build.h"
#include "host/scene/scene.h"
#include "kernels/features.h"
#include "kernels/scene_types.h"

namespace wavepath {

// Something that this scene does not need and therefore does not get.
struct LeftOut {
  std::string what, why;
  std::uint64_t bytes = 0;   // that it would have cost on the device
  std::uint32_t feature = 0; // kFeature bit of the code that goes with it; 0 = data alone
};

// Triangles that lie side by side in PackedScene::triangles, as instances that lie side by side place them.
struct Draw {
  std::uint32_t first_triangle = 0, triangle_count = 0; // copies of spatial splits included
  std::uint32_t first_instance = 0, instance_count = 1; // 0 and 1 where the scene has no instances
};

struct PackedScene {
  glm::dvec3 origin{0.0}; // world position of the device's zero
  double radius = 0.0;    // of the geometry's bounding sphere, metres

  std::vector<bvh::WideNode> nodes;
  std::uint32_t root = 0; // node
  bool root_is_top = false;
  std::uint32_t stack_size = 0; // traversal stack entries that suffice for certain
  std::vector<gpu::Triangle> triangles;
  std::vector<gpu::Instance> instances; // empty unless root_is_top
  std::vector<Draw> draws;              // together, every triangle that can be seen

  // Empty where no surface of the scene needs them (see the kFeature bits).
  std::vector<glm::uvec4> triangle_vertices;
  std::vector<glm::vec4> vertex_normals, vertex_uvs, vertex_colors;

  std::vector<gpu::Material> materials;
  std::vector<std::string> material_names; // for messages
  std::vector<gpu::Texture> textures;
  std::vector<std::uint32_t> texels;

  std::vector<gpu::Light> lights; // what next-event estimation picks from; the environment is one of them
  glm::vec3 environment_radiance{0.0f};
  float environment_probability = 0.0f;
  double environment_rotation = 0.0;
  std::uint32_t environment_width = 0, environment_height = 0;
  std::vector<glm::vec4> environment;        // radiance, probability of the texel
  std::vector<glm::uvec2> environment_alias; // bits of the threshold, alias

  std::uint32_t features = 0; // kFeature bits
  std::vector<LeftOut> left_out;
  std::uint64_t triangle_count = 0;    // as seen: instances counted
  std::uint64_t dropped_triangles = 0; // non-finite or degenerate
  double bvh_seconds = 0.0;
  bvh::Quality bvh_quality = bvh::Quality::fast;
  std::uint64_t triangles_stored = 0; // without the copies of spatial splits
  double sah_cost = 0.0; // of the tree over the most triangles, see bvh::Measure
};

// What a scene will take on the device, computed before anything is laid out. Exact but for tree nodes (an average of
// real scenes), lights (every triangle of a textured emitter counts, though most may prove black) and spatial splits (as
// many copies as they may make).
struct Plan {
  std::uint64_t triangle_bytes = 0, node_bytes = 0, vertex_bytes = 0, texel_bytes = 0, environment_bytes = 0,
                light_bytes = 0;
  std::uint64_t triangles_stored = 0, triangles_seen = 0, instances = 0;
  std::uint64_t largest_buffer = 0; // bytes of the largest single array
  std::uint64_t total() const {
    return triangle_bytes + node_bytes + vertex_bytes + texel_bytes + environment_bytes + light_bytes;
  }
};
Plan plan(const Scene& scene, bvh::Quality quality = bvh::Quality::fast);

// `direct` (kDirect*): with kDirectBsdf no light is packed for sampling. `eye`: where single precision should be finest,
// as from a bolt on a planet one sees the bolt; the origin is the point of the geometry's box nearest to it, or its
// centre. Adds warnings about what it dropped to scene.warnings.
PackedScene pack(Scene& scene, std::uint32_t direct = gpu::kDirectMis, bvh::Quality quality = bvh::Quality::fast,
                 const std::optional<glm::dvec3>& eye = {});

// Packed tangent in the w of vertex_normals, as float bits: 31..16 and 15..1 hold the octahedral x and y of the
// direction (Meyer et al. 2010; lower hemisphere where z < 0), each mapped from [-1,1] to [0, 65535] and [0, 32767];
// bit 0 is set where tangent.w < 0. No direction is stored as 0, which therefore stands for "no tangent". surface.glsl
// holds the inverse.
float pack_tangent(const glm::vec4& tangent);

} // namespace wavepath
