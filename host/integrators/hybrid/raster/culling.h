// Leaves out of drawing what the camera cannot see: ranges of triangles whose box lies outside of the picture.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

// Triangles that lie together, because they lie together in the order of the tree; bounds in device world space.
struct Chunk {
  Draw draw; // draw of one instance
  glm::dvec3 centre{0.0}, half{0.0};
};
std::vector<Chunk> make_chunks(const PackedScene& scene);

// The part of a camera's space that its picture shows, beyond what gpu::CameraView tells: see View.
struct ShownPart {
  glm::dvec2 shift{0.0};
  Clip clip{};
};

// The draws of all chunks that may be seen in a picture of this size, in their order, neighbours joined. What it leaves
// out covers no pixel, for any position in the pixel filter.
std::vector<Draw> visible_draws(std::span<const Chunk> chunks, const gpu::CameraView& camera, std::uint32_t width,
                                std::uint32_t height, const ShownPart& part = {});

// Inside where dot(normal, p) + offset >= 0.
struct HalfSpace {
  glm::dvec3 normal{0.0};
  double offset = 0.0;
};

// The draws of all chunks whose box reaches into every half-space.
std::vector<Draw> draws_within(std::span<const Chunk> chunks, std::span<const HalfSpace> sides);

} // namespace wavepath
