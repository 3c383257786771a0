#include "host/scene/pack/plan.h"

#include <algorithm>

#include "host/scene/pack/cut_scene.h"
#include "host/scene/pack/environment_light.h"
#include "host/scene/pack/light_tree.h"
#include "host/scene/pack/lights.h"
#include "host/scene/pack/materials.h"
#include "host/scene/pack/vertices.h"
#include "host/scene/pack/volume.h"

namespace wavepath {
namespace {

// Trees over triangles measured 3.4 (subdivided surfaces) to 4.5 triangles a node on real scenes. Instances have leaves
// of their own, so that a node holds two of them, its other children being nodes.
std::uint64_t triangle_node_bytes(std::uint64_t triangles) { return (2 * triangles / 7 + 1) * sizeof(bvh::WideNode); }
std::uint64_t instance_node_bytes(std::uint64_t instances) { return (instances / 2 + 1) * sizeof(bvh::WideNode); }

bool is_smooth(const Material& m) {
  return !m.unlit && m.roughness * m.roughness < gpu::kMinAlpha &&
         (m.transmission > 0.0f || m.metallic > 0.0f || m.specular > 0.0f);
}

} // namespace

ScenePlan plan(const Scene& scene, const Packing& packing) {
  const Usage usage = find_usage(scene);
  const Streams streams = needed_streams(scene, usage);
  const MaterialTable materials = pack_materials(scene, usage, packing.mips, packing.samplers);

  ScenePlan plan;
  plan.triangles_stored = usage.triangles_stored;
  plan.triangles_seen = usage.triangles_seen;
  plan.instances = usage.two_level() ? usage.shared_instances + 1 : 0;
  const CutSize cut = count_pieces(scene, usage, packing.near);
  const std::uint64_t whole = usage.triangles_stored + cut.pieces - cut.triangles;
  const std::uint64_t vertices = usage.vertex_count + 3 * cut.pieces;
  const double copies = packing.quality == bvh::Quality::fast ? 0.0 : bvh::BuildConfig{}.max_copies;
  const std::uint64_t items = whole + static_cast<std::uint64_t>(copies * static_cast<double>(whole));
  const bool moving = std::ranges::any_of(scene.meshes, &Mesh::moves);
  const std::uint64_t triangles = (moving ? 2 : 1) * items * sizeof(gpu::Triangle);
  const std::uint64_t corners = streams.any() || cut.pieces > 0 ? items * sizeof(glm::uvec4) : 0;
  const std::uint64_t stream = vertices * sizeof(glm::vec4);
  const std::uint64_t placed = plan.instances * sizeof(gpu::Instance);
  const std::uint64_t environment = scene.environment.present() ? scene.environment.map.size() * sizeof(glm::vec4) : 0;
  plan.triangle_bytes = triangles + corners;
  const std::uint64_t nodes = triangle_node_bytes(items) + (placed > 0 ? instance_node_bytes(plan.instances) : 0);
  plan.node_bytes = nodes + placed;
  const std::uint64_t normals = // of one buffer
      (unsigned{streams.normals} + unsigned{streams.normals && moving} + unsigned{streams.layer_tangents}) * stream;
  plan.vertex_bytes = normals + (unsigned{streams.uvs} + unsigned{streams.colors}) * stream;
  const std::uint64_t texels = materials.textures.word_count * sizeof(std::uint32_t);
  const Atlases& atlases = materials.textures.atlases;
  plan.texel_bytes = texels + atlases[0].bytes() + atlases[1].bytes();
  plan.environment_bytes = environment;
  if (environment > 0)
    plan.environment_bytes +=
        environment_interval_words(scene.environment.width, scene.environment.height) * sizeof(std::uint32_t);
  const std::uint64_t local_lights = count_emitters(scene, usage) + cut.shining + scene.lights.size();
  plan.light_bytes = (local_lights + 1) * sizeof(gpu::Light);
  if (local_lights > kFewLights) plan.light_tree_bytes = light_tree_bytes(local_lights);
  if (scene.volume) plan.voxel_bytes = voxel_bytes(*scene.volume->grids);
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    plan.smooth_surfaces |= usage.material_used[m] && is_smooth(scene.materials[m]);
  plan.largest_buffer =
      std::max({triangles, corners, nodes, placed, streams.any() ? std::max(stream, normals) : 0, texels,
                atlases[0].bytes(), atlases[1].bytes(), environment, plan.light_bytes, plan.voxel_bytes});
  return plan;
}

} // namespace wavepath
