// The field that guides paths: where light comes from, by position and direction, as training found it.
//
// Built on the host from the vertices of the training pass, in an order that depends on nothing but their numbers, so
// that the same pass gives the same bits. kernels/path/guide.glsl reads it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/path/path_types.h"

namespace wavepath {

inline constexpr std::uint32_t kMostGuideLeaves = 8192; // 36 MB of maps
inline constexpr std::uint64_t kGuideMapBytes =
    std::uint64_t{kMostGuideLeaves} * gpu::kGuideMapTexels * sizeof(glm::uvec4);
inline constexpr std::uint64_t kGuideTreeBytes = 4 * std::uint64_t{kMostGuideLeaves} * sizeof(gpu::GuideNode);

// A vertex of a training path: where it scattered, in which direction, and the light from there.
struct GuideVertex {
  glm::vec3 position{0.0f};
  float pdf = 0.0f; // of the direction
  glm::vec3 direction{0.0f};
  float bsdf_pdf = 0.0f;          // by the BSDF alone
  float guidable_fraction = 0.0f; // of the BSDF that can be guided
  float radiance = 0.0f;          // luminance that came from there
  float contribution = 0.0f;      // luminance that the pixel's sample gained thereby
  bool odd = false;               // which half of the paths it belongs to
};

struct GuideField {
  std::vector<gpu::GuideNode> nodes; // the root first
  std::vector<glm::uvec4> maps;      // kGuideMapTexels a leaf
  // Second moment of the contributions with the field over that without it, as one half of the paths predicts for the
  // other: below 1 where guiding pays.
  double gain = 1.0;
  double probability = 0.0; // of guiding, over all vertices
  std::uint32_t leaves() const { return static_cast<std::uint32_t>(maps.size() / gpu::kGuideMapTexels); }
};

// A field that guides nowhere.
GuideField no_field();
GuideField build_field(std::span<const GuideVertex> vertices);

} // namespace wavepath
