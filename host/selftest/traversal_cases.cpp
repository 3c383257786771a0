// Cases of the tree and the triangle test: closed meshes, extreme places and scales, degenerate input.
#include <fmt/format.h>

#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"

namespace wavepath {
namespace {

gpu::Ray ray_along(glm::vec3 origin, glm::vec3 direction) { return {origin, 0, glm::normalize(direction), gpu::kFar}; }

Measurement empty_scenes(const SelftestContext& context) {
  std::uint64_t failures = 0;
  for (std::size_t count = 0; count <= 2; ++count) {
    Scene scene;
    const std::uint32_t material = add_lambert(scene, glm::vec3(0.5f));
    std::vector<glm::vec3> positions;
    for (std::size_t i = 0; i < count; ++i) {
      const float z = -1.0f - static_cast<float>(i);
      positions.insert(positions.end(), {{-1, -1, z}, {1, -1, z}, {0, 1, z}});
    }
    if (count > 0) add_triangles(scene, positions, material);
    const PackedScene packed = pack(scene, gpu::kDirectMis, bvh::Quality::fast);
    const gpu::Ray ray = ray_along(glm::vec3(glm::dvec3(0.0, 0.0, 5.0) - packed.origin), {0, 0, -1});
    const gpu::Hit hit = trace_on_device(context.device, packed, {&ray, 1}).front();
    const bool found = hit.triangle != gpu::kNone && packed.triangles[hit.triangle].id == 0;
    failures += count == 0 ? hit.triangle != gpu::kNone : !found;
  }
  return judge_none(failures, 3, "wrong hits");
}

constexpr SelftestCase kCases[] = {
    {17, "empty scene, one and two triangles", "tiny scenes come out empty or wrong", empty_scenes},
};

} // namespace

std::span<const SelftestCase> traversal_cases() { return kCases; }

} // namespace wavepath
