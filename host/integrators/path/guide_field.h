// The guiding field: incident light by position and direction, as training found it.
//
// It is built on the host from the vertices of the training pass, in the order of their numbers, so that the same pass
// gives the same bits. kernels/path/guide.glsl reads it. Positions are in the device's world space.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/path/path_types.h"

namespace wavepath {

inline constexpr std::uint32_t kMostGuideLeaves = 8192; // its maps take 36 MB
inline constexpr std::uint64_t kGuideMapBytes =
    std::uint64_t{kMostGuideLeaves} * gpu::kGuideMapTexels * sizeof(glm::uvec4);
inline constexpr std::uint64_t kGuideTreeBytes = 4 * std::uint64_t{kMostGuideLeaves} * sizeof(gpu::GuideNode);

// A vertex of a training path: its position, the direction it scattered into, and the light from there.
struct GuideVertex {
  glm::vec3 position{0.0f};
  float pdf = 0.0f; // density of the direction per solid angle, by all techniques
  glm::vec3 direction{0.0f};
  float bsdf_pdf = 0.0f;          // the same by the BSDF alone
  float guidable_fraction = 0.0f; // part of the BSDF that can be guided
  float radiance = 0.0f;          // luminance that arrived from the direction
  float contribution = 0.0f;      // luminance that this light added to the pixel's sample
  bool odd = false;               // the half of the paths that it belongs to
};

struct GuideField {
  std::vector<gpu::GuideNode> nodes; // nodes[0] is the root
  std::vector<glm::uvec4> maps;      // kGuideMapTexels for each leaf
  // Second moment of the contributions with the field, relative to that without. Half of the paths predicts it for the
  // other half. Below 1, guiding pays.
  double gain = 1.0;
  double probability = 0.0; // average probability of guiding at a vertex
  std::uint32_t leaves() const { return static_cast<std::uint32_t>(maps.size() / gpu::kGuideMapTexels); }
};

// A field that guides no vertex.
GuideField no_field();
GuideField build_field(std::span<const GuideVertex> vertices);

} // namespace wavepath
