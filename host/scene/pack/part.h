// A primitive to be packed, and the space that it is packed in.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "host/scene/material.h"

namespace wavepath {

// A mesh with one instance is transformed while it is packed ("baked"); a mesh with several has the identity here, and
// its instances hold the transforms.
struct Part {
  std::uint32_t mesh = 0;
  std::uint32_t primitive = 0;
  std::uint32_t surface = 0;      // kTriangle bits and an index into PackedScene::materials, see gpu::Triangle
  std::uint32_t first_vertex = 0; // first vertex of the mesh in the vertex streams
  glm::dmat4 device_from_object{1.0};
  bool mirrored = false; // the transform mirrors: v1 and v2 change places, so that counter-clockwise stays the front
  std::uint32_t node = kNoIndex; // node of the file that shows a mesh with one instance
};

} // namespace wavepath
