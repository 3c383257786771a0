// The vertex streams: normals with packed tangents, texture coordinates and colours of every mesh in use.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/scene/pack/cut.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/usage.h"

namespace wavepath {

// The vertex streams that a scene needs. A stream covers all vertices.
struct Streams {
  bool normals = false, uvs = false, colors = false, layer_tangents = false;
  bool any() const { return normals || uvs || colors; }
  unsigned count() const { return unsigned{normals} + unsigned{uvs} + unsigned{colors} + unsigned{layer_tangents}; }
};
Streams needed_streams(const Scene& scene, const Usage& usage);

// A vertex of a piece: `weights` among the vertices of the triangle that was cut.
struct CutVertex {
  std::uint32_t mesh = 0, first_index = 0; // mesh and first index of the triangle
  glm::vec2 uv_shift[2] = {};              // whole numbers that are subtracted from texture coordinates
  glm::dvec3 weights{0.0};
};

// Fills packed.vertex_normals (in a scene that moves twice: open shutter, closed shutter; then packed tangents of coat
// and grain, open and closed, where layers have their own), vertex_uvs and vertex_colors. Normals and tangents of
// meshes that are shown once are turned into world space (normals by the inverse transpose), those of shared meshes
// stay as they are. A normal that is not finite becomes zero, and so does a texture coordinate; returns the number
// of these. Behind the vertices of the meshes stand those of `cut`.
std::size_t pack_vertices(const Scene& scene, const Usage& usage, const Streams& streams,
                          std::span<const CutVertex> cut, PackedScene& packed);

// The same of one mesh that is shown once, elsewhere than when the rest was packed. Nothing moves, and nothing was cut.
void pack_moved_vertices(const Scene& scene, const Usage& usage, const Streams& streams, std::uint32_t mesh,
                         const glm::dmat4& world_from_object, PackedScene& packed);

// The vertices of all pieces, three each.
void list_cut_vertices(const Scene& scene, std::span<const Part> parts, const Cut& cut, std::vector<CutVertex>& list);

// Packed tangent in the w of vertex_normals, as float bits: 31..16 and 15..1 hold the octahedral x and y of the
// direction (Meyer et al. 2010; lower hemisphere where z < 0), each mapped from [-1,1] to [0, 65535] and [0, 32767];
// bit 0 is set where tangent.w < 0. No direction is stored as 0, which therefore stands for "no tangent". surface.glsl
// holds the inverse.
float pack_tangent(const glm::vec4& tangent);

} // namespace wavepath
