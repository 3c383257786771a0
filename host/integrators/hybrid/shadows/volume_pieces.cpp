#include "host/integrators/hybrid/shadows/volume_pieces.h"

#include <array>
#include <bit>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "host/integrators/hybrid/raster/placed_triangles.h"
#include "kernels/hybrid/shadows/volume_types.h"

namespace wavepath {
namespace {

struct PositionHash {
  std::size_t operator()(const glm::dvec3& p) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis)
      hash = (hash ^ std::bit_cast<std::uint64_t>(p[axis])) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return hash;
  }
};

// Numbers of what is met for the first time, one after the other.
template <typename Key, typename Hash>
class Numbers {
public:
  std::uint32_t operator[](const Key& key) {
    return known_.try_emplace(key, static_cast<std::uint32_t>(known_.size())).first->second;
  }
  std::uint32_t count() const { return static_cast<std::uint32_t>(known_.size()); }

private:
  std::unordered_map<Key, std::uint32_t, Hash> known_;
};

struct EdgeHash {
  std::size_t operator()(std::uint64_t edge) const { return edge * 0x9e3779b97f4a7c15u ^ edge >> 31; }
};

// -0 is 0 in them, so that equal ones have equal bits.
std::array<glm::dvec3, 3> comparable_corners(const gpu::Triangle& triangle, const gpu::Instance* instance) {
  std::array<glm::dvec3, 3> corners = placed_corners(triangle, instance);
  for (glm::dvec3& corner : corners) corner += 0.0;
  return corners;
}

const gpu::Material& material_of(const PackedScene& scene, const gpu::Triangle& triangle) {
  return scene.materials[triangle.surface & gpu::kTriangleMaterialMask];
}

// Unlit surfaces take no light away.
bool casts(const PackedScene& scene, const gpu::Triangle& triangle) {
  return !(triangle.surface & gpu::kTriangleAlpha) || !(material_of(scene, triangle).flags & gpu::kMaterialUnlit);
}

// Spatial splits make copies, of which the first counts.
template <typename Visit>
void for_each_caster(const PackedScene& scene, const Visit& visit) {
  for (const Draw& draw : scene.draws) {
    std::unordered_set<std::uint32_t> known;
    for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
      if (!casts(scene, scene.triangles[t]) || !known.insert(scene.triangles[t].id).second) continue;
      for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i) visit(t, i);
    }
  }
}

} // namespace

VolumeCasters::VolumeCasters(const PackedScene& scene, bool culls_backs) : scene_(scene) {
  Numbers<glm::dvec3, PositionHash> corner_numbers;
  Numbers<std::uint64_t, EdgeHash> edge_numbers;
  for_each_caster(scene, [&](std::uint32_t t, std::uint32_t i) {
    const gpu::Instance* instance = scene.root_is_top ? &scene.instances[i] : nullptr;
    const auto corners = comparable_corners(scene.triangles[t], instance);
    Caster caster{};
    caster.triangle = t;
    caster.instance = i;
    caster.corner = corners[0];
    caster.normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    caster.lit_from_behind = !culls_backs || !(scene.triangles[t].surface & gpu::kTriangleSingleSided);
    caster.flipped = instance && instance->flipped;
    for (int k = 0; k < 3; ++k) {
      std::uint64_t a = corner_numbers[corners[k]], b = corner_numbers[corners[(k + 1) % 3]];
      caster.directions[k] = a < b ? 1 : a > b ? -1 : 0;
      if (a > b) std::swap(a, b);
      caster.edges[k] = edge_numbers[a << 32 | b];
    }
    casters_.push_back(caster);
  });
  edge_count_ = edge_numbers.count();
}

VolumePieces VolumeCasters::pieces(const ShadowSource& source, bool caps) const {
  const bool is_point = source.kind != kDirectionalSource;
  std::vector<int> net(edge_count_, 0); // how many more sides an edge has in its direction than in the other
  std::vector<signed char> turns(casters_.size(), 0); // 1: corners are counter-clockwise as the light sees them
  VolumePieces pieces;
  const auto word = [](const Caster& caster, std::uint32_t bits) {
    return glm::uvec2(caster.triangle, caster.instance << gpu::kVolumeBits | bits);
  };
  for (std::size_t c = 0; c < casters_.size(); ++c) {
    const Caster& caster = casters_[c];
    const glm::dvec3 to_light = is_point ? source.position - caster.corner : -source.direction;
    const bool faces = glm::dot(caster.normal, to_light) > 0.0;
    if (faces == caster.flipped && !caster.lit_from_behind) continue;
    turns[c] = faces ? 1 : -1;
    for (int k = 0; k < 3; ++k) net[caster.edges[k]] += turns[c] * caster.directions[k];
    if (!caps) continue;
    (faces ? pieces.outwards : pieces.inwards).push_back(word(caster, gpu::kVolumeCap));
    if (is_point) // the image at infinity faces away from the light; of a sun it is a point
      pieces.outwards.push_back(word(caster, gpu::kVolumeCap | gpu::kVolumeFar | (faces ? gpu::kVolumeReversed : 0u)));
  }
  for (std::size_t c = 0; c < casters_.size(); ++c) {
    const Caster& caster = casters_[c];
    for (std::uint32_t k = 0; k < 3 && turns[c] != 0; ++k) {
      int& count = net[caster.edges[k]];
      const bool reversed = (count > 0) != (caster.directions[k] > 0);
      for (; count != 0; count += count > 0 ? -1 : 1) {
        const std::uint32_t bits = k | (reversed ? gpu::kVolumeReversed : 0u);
        pieces.outwards.push_back(word(caster, bits));
        if (is_point) pieces.outwards.push_back(word(caster, bits | gpu::kVolumeFar));
      }
    }
  }
  return pieces;
}

const gpu::Triangle* VolumeCasters::open_triangle() const {
  std::vector<int> net(edge_count_, 0);
  for (const Caster& caster : casters_)
    for (int k = 0; k < 3; ++k) net[caster.edges[k]] += caster.directions[k] * (caster.flipped ? -1 : 1);
  for (const Caster& caster : casters_)
    for (int k = 0; k < 3; ++k)
      if (net[caster.edges[k]] != 0) return &scene_.triangles[caster.triangle];
  return nullptr;
}

std::string open_mesh(const PackedScene& scene) {
  const VolumeCasters casters(scene, false);
  const gpu::Triangle* open = casters.open_triangle();
  if (!open) return "";
  const std::uint32_t material = open->surface & gpu::kTriangleMaterialMask;
  return fmt::format("is for closed meshes, and what has material {} is open",
                     material < scene.material_names.size() && !scene.material_names[material].empty()
                         ? fmt::format("\"{}\"", scene.material_names[material])
                         : fmt::format("{}", material));
}

} // namespace wavepath
