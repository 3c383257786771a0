// A scene as plain arrays and indices: the contents of a glTF file, decoded and validated, not yet packed for the
// device. Units and axes are glTF's: metres, right-handed, +Y up. Colours are linear unless an image says otherwise.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/base/warnings.h"
#include "host/scene/material.h"
#include "host/scene/volume.h"

namespace wavepath {

// Decoded texels, four channels, top row first (glTF's uv origin is the top left corner).
struct Image {
  std::string name; // for messages
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> bytes; // RGBA8 as stored in the file (sRGB or linear by use); empty if `floats` is used
  std::vector<float> floats;       // RGBA, for images of more than 8 bits: values 0..1 as stored, not yet linearized
};

// A run of triangles with one material: indices [first_index, first_index + index_count) of its mesh.
struct Primitive {
  std::uint32_t first_index = 0, index_count = 0;
  std::uint32_t material = 0; // always valid: the default material is appended when a file needs it
  bool has_normals = false;   // otherwise flat
};

// Triangles in the mesh's own space, morphed and (if skinned) already placed. Vertex arrays are empty or
// position-sized.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals; // unit length; zero where a primitive is flat
  // xyz: unit length; w = +-1. Read from the file or computed compatibly with MikkTSpace. Filled only if a normal map
  // needs them.
  std::vector<glm::vec4> tangents;
  // Tangents of layers (kCoatTangents, kGrainTangents) whose texture is read by other coordinates; empty if they are
  // the same.
  std::vector<glm::vec4> layer_tangents[2];
  std::vector<glm::vec2> uvs[2]; // the sets of the file that the material of each primitive reads
  std::vector<glm::vec4> colors; // COLOR_0, linear RGBA
  std::vector<std::uint32_t> indices;
  std::vector<Primitive> primitives;
  // A number that only meshes with the same vertices, indices and primitives share (new_content()); 0: none is known.
  std::uint64_t content = 0;
  // Vertices that move while the shutter is open: where they are when it closes, in the same space. Empty = they stay.
  std::vector<glm::vec3> end_positions, end_normals;
  std::vector<glm::vec4> end_tangents, end_layer_tangents[2];

  bool moves() const { return !end_positions.empty(); }
};

std::uint64_t new_content(); // that no mesh of the process has

struct Instance {
  std::uint32_t mesh = 0;
  // Affine, finite, invertible: the loader makes a flat matrix a flat mesh and drops others with a warning.
  glm::dmat4 world_from_object{1.0};
  std::uint32_t node = kNoIndex; // of the file, that shows it; kNoIndex: no node does
};

struct Camera {
  std::string name;
  bool orthographic = false;
  double yfov = 0.8;                 // radians, perspective
  double aspect = 0.0;               // width over height that it was authored for; 0 = any
  double xmag = 1.0, ymag = 1.0;     // half extents, orthographic
  std::optional<double> znear, zfar; // clip planes of the file, in metres; rays pass them unless --clip asks for them
  glm::dmat4 world_from_camera{1.0}; // looks along its -Z, +Y up
};

// A measured luminaire (IES LM-63): its intensity by direction, relative to the largest. Vertical angles ascend from
// that of the first to that of the last value, outside of which it is dark. Horizontal angles ascend from 0 or below
// to 2 pi or above, or there is one, of a luminaire that is alike all around.
struct LightProfile {
  std::string name;
  std::vector<float> vertical, horizontal; // radians
  std::vector<float> intensities;          // by horizontal angle, then by vertical angle

  bool operator==(const LightProfile&) const = default;
};

enum class LightKind : std::uint8_t { point, spot, directional };

struct PunctualLight {
  std::string name;
  LightKind kind = LightKind::point;
  glm::vec3 intensity{1.0f}; // colour * intensity: candela, or lux for directional
  glm::dvec3 position{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};                     // of emission, unit length
  double inner_cone = 0.0, outer_cone = 0.7853981633974483; // radians, half angles
  double range = 0.0; // metres at which a point or spot light has faded to nothing; 0 = nowhere
  // Of a soft lamp: radius in metres, or half the angle in radians under which a directional light is seen; 0 = none.
  double extent = 0.0;
  std::uint32_t node = kNoIndex; // of the file, that carries it; kNoIndex: no node does
  // A point light: factor on its intensity, one of Scene::profiles. `direction` is that of vertical angle 0, `tangent`
  // that of horizontal angle 0 beside it.
  std::uint32_t profile = kNoIndex;
  glm::dvec3 tangent{1.0, 0.0, 0.0};

  bool operator==(const PunctualLight&) const = default;
};

// Radiance from infinity. `map` is lat-long, RGB, top row = +Y, centre column = +X (see lat_long.h); empty = constant.
struct Environment {
  glm::vec3 radiance{0.0f}; // constant radiance, or the scale of the map
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec3> map;
  double rotation = 0.0; // radians about +Y, counter-clockwise seen from above

  bool present() const { return glm::any(glm::greaterThan(radiance, glm::vec3(0.0f))); }
};

struct Scene {
  std::string path;
  std::vector<std::string> files; // buffers and images beside it, those that nothing uses included
  std::vector<Image> images;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<std::string> node_names;     // by node of the file; empty where it has no name
  std::vector<std::uint32_t> node_parents; // likewise; kNoIndex where it has none
  std::vector<Camera> cameras;
  std::vector<PunctualLight> lights;
  std::vector<LightProfile> profiles;
  Environment environment;
  std::optional<Volume> volume;
  // Materials first <= m < end are those of the shadow catcher alone (host/scene/staging/catcher.h).
  std::uint32_t first_catcher = 0, end_catcher = 0;
  std::vector<std::string> extensions_used;
  std::vector<std::string> variants; // names of KHR_materials_variants
  Warnings warnings;
};

} // namespace wavepath
