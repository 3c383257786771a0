// A scene of another renderer, described in terms that glTF has: what the readers fill in and write_gltf() writes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/base/warnings.h"
#include "host/convert/images.h"

namespace wavepath::convert {

// Triangles. Texture coordinates are those of glTF: v grows downwards.
struct Mesh {
  std::vector<glm::vec3> positions, normals; // normals: one for each position, or none
  std::vector<glm::vec2> uvs;                // likewise
  std::vector<std::uint32_t> indices;
};

// A value over a surface: a factor, times an image where there is one.
struct Texture {
  glm::dvec3 factor{1.0};
  std::uint32_t image = kNoImage;
  glm::dvec2 uv_scale{1.0}, uv_offset{0.0}; // uv' = uv * scale + offset
  bool clamps = false, nearest = false;

  bool is_constant() const { return image == kNoImage; }
  bool operator==(const Texture&) const = default;
};

// The properties of a glTF material that other renderers have too.
struct Material {
  std::string name;
  Texture base;
  Texture alpha;         // its red
  Texture roughness;     // red; that of glTF, whose square is alpha of the microfacets
  Texture metallic{{}};  // red
  Texture normal{{}};    // a normal map, if it has an image
  double specular = 0.0; // specularFactor: 0 has no specular layer at all
  glm::dvec3 specular_color{1.0};
  double ior = 1.5;
  double transmission = 0.0;
  bool volume = false;                         // a body that refracts, no pane
  glm::dvec3 absorption{0.0}, scattering{0.0}; // 1/m, in the volume
  double anisotropy_of_scattering = 0.0;       // g of Henyey and Greenstein
  double coat = 0.0, coat_roughness = 0.0;
  glm::dvec3 sheen{0.0};
  double sheen_roughness = 0.0;
  double anisotropy = 0.0, anisotropy_rotation = 0.0;
  double diffuse_transmission = 0.0;
  glm::dvec3 diffuse_transmission_color{1.0};
  Texture emission{{}}; // radiance
  bool double_sided = true;
  bool is_boundary = false; // of a medium, and else invisible
};

struct Shape {
  std::string name;
  std::uint32_t mesh = 0, material = 0;
  glm::dmat4 matrix{1.0};
};

struct Use { // of a group of shapes
  std::uint32_t group = 0;
  glm::dmat4 matrix{1.0};
};

enum class LightKind : std::uint8_t { point, spot, directional };

struct Light {
  LightKind kind = LightKind::point;
  glm::dvec3 intensity{0.0}; // W/sr, or W/m^2 of a directional one
  glm::dvec3 position{0.0}, direction{0.0, 0.0, -1.0};
  double inner = 0.0, outer = 0.0; // radians
};

struct Camera {
  glm::dmat4 world_from_camera{1.0}; // +X right, +Y up, looks along -Z
  bool orthographic = false;
  double yfov = 0.0;                  // radians
  double xmag = 1.0, ymag = 1.0;      // of an orthographic one
  double aperture = 0.0, focus = 0.0; // radius of the lens and distance in focus; 0: none
};

// A volume of voxels, as the extras of a node have it.
struct Volume {
  std::vector<std::uint8_t> file;              // of NanoVDB
  std::string uri;                             // of this file, once that is known
  glm::dvec3 absorption{0.0}, scattering{0.0}; // where the density is 1, in 1/m
  double anisotropy = 0.0;                     // g of Henyey and Greenstein
  double emission = 0.0;                       // factor on that of black bodies
  double temperature_scale = 1.0, temperature_offset = 0.0;
  glm::dmat4 matrix{1.0};
};

// Light from far away: a colour, or a picture whose pixels are radiance.
struct Environment {
  glm::dvec3 color{0.0};
  std::vector<float> pixels; // RGB, lat-long as --env takes them, of the world of the file that is written
  std::uint32_t width = 0, height = 0;
};

struct Description {
  std::string format; // "pbrt-v4"
  Images images;
  std::vector<Mesh> meshes;
  std::vector<Material> materials;
  std::vector<Shape> shapes;
  std::vector<std::vector<Shape>> groups;
  std::vector<Use> uses;
  std::vector<Light> lights;
  std::optional<Volume> volume;
  std::optional<Camera> camera;
  std::optional<Environment> environment;
  glm::dmat4 root{1.0};                // of all but camera and environment: mirrors a left-handed world
  std::uint32_t width = 0, height = 0; // of the film; 0: not said
  double film_gain = 1.0;              // of the film's sensor
  int max_depth = -1;
  Warnings losses;
};

// `camera_from_gltf`: the right, up and view axes of a format's cameras, in those of glTF's. The camera and the root
// that it sets do not mirror the picture.
void place_camera(Description& description, Camera camera, const glm::dmat4& world_from_camera,
                  const glm::dmat4& camera_from_gltf);

} // namespace wavepath::convert
