// A scene that stays on a device while things about it change, and the renders of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <wavepath/camera.h>
#include <wavepath/device.h>
#include <wavepath/export.h>
#include <wavepath/result.h>
#include <wavepath/scene.h>
#include <wavepath/settings.h>

namespace wavepath_v0 {

struct Progress {
  std::uint32_t spp = 0, planned_spp = 0;
  double fraction = 0.0; // of the planned samples that are done
  double seconds = 0.0;  // of rendering so far
  double error = 0.0;    // estimated relative RMS error; 0 until known
  double mrays_per_second = 0.0;
};

struct Hooks {
  // Called about every 100 ms on the thread that renders. Returns false to end the render with what it has.
  std::function<bool(const Progress&)> progress{};
  // Called with the picture so far, about every `picture_seconds`.
  std::function<void(const Result&)> picture{};
  double picture_seconds = 1.0;
};

// Something of a scene: its name, which may be empty or the name of others too, and its index.
struct Named {
  std::string name;
  std::size_t index = 0;
};

// What an update did again, such as {"materials", 0.2} or {"tree", 4.1}, in milliseconds.
struct Redone {
  std::string what;
  double milliseconds = 0.0;
};

// Texels of a texture, or of an environment: rows from the top, `channels` values for each texel.
struct Texels {
  std::uint32_t width = 0, height = 0, channels = 4;
  std::vector<std::uint8_t> bytes{}; // as a file of 8 bits stores them: colours in sRGB
  std::vector<float> floats{}; // the same range, 0 to 1; of an environment: linear radiance. Empty if `bytes` are given
};

// Triangles. `positions`, `normals`: x, y, z of each vertex; `uvs`: u, v; `indices`: three for each triangle.
struct MeshData {
  std::string name{};
  std::vector<float> positions{}, normals{}, uvs{}; // normals and uvs may be empty
  std::vector<std::uint32_t> indices{};
  std::size_t material = 0;
  Matrix4 world_from_object{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
};

struct SessionState;

// Methods may be called from several threads; they run one after the other.
class WAVEPATH_API Session {
public:
  // Loads the scene and opens the device. `settings`: as for render(); kernels begin to compile for them. Throws Error.
  explicit Session(const Scene& scene, const Settings& settings = {}, const std::optional<Device>& device = {});

  std::vector<Named> cameras() const;
  std::vector<Named> nodes() const;
  std::vector<Named> materials() const;
  std::vector<std::string> variants() const; // of the materials; the flag "variant" takes one
  std::vector<Named> lights() const;         // those of visible nodes; index: the node, or kAddedLight
  std::array<Point, 2> bounds() const;       // corners of the box around all vertices and the volume
  Device device() const;

  // Edits are noted; update() or the next render() does them, and only what they touch. An edit that is taken back
  // leaves no trace: pictures have the bits of a file that says the same. Each throws Error at once for arguments that
  // make no sense.
  //
  // Fields of a material, such as "base_color" (4 values), "roughness" (1), "emission" (3).
  static const std::vector<std::string>& material_fields();
  static const std::vector<std::string>& material_textures(); // "base_color_texture", ...
  std::vector<double> material(std::size_t material, const std::string& field) const;
  void set_material(std::size_t material, const std::string& field, const std::vector<double>& value);
  void set_texture(std::size_t material, const std::string& texture, const Texels& texels);
  std::size_t add_material(const std::string& name); // with glTF's defaults; returns its index
  // Fields of a light: "intensity" (3 values, candela, or lux of a directional one), "range" (metres; 0 = none),
  // "cones" (inner and outer half angle of a spot in degrees), "radius" (metres) or "angle" (of a directional one, in
  // degrees across) of a soft one. A light is named by the node that carries it, or is kAddedLight: the sun or lamp
  // that wavepath has added. Place, direction and visibility are those of the node.
  static constexpr std::size_t kAddedLight = static_cast<std::size_t>(-1);
  static const std::vector<std::string>& light_fields();
  std::vector<double> light(std::size_t node, const std::string& field) const;
  void set_light(std::size_t node, const std::string& field, const std::vector<double>& value);
  // Matrix of a node, relative to its parent, as glTF has it. Its children follow.
  Matrix4 matrix(std::size_t node) const;
  void set_matrix(std::size_t node, const Matrix4& parent_from_node);
  void reset_matrix(std::size_t node);
  bool is_visible(std::size_t node) const;
  void set_visible(std::size_t node, bool is_visible); // its children follow
  std::size_t add_mesh(const MeshData& mesh);          // returns its node
  void remove_mesh(std::size_t node);                  // that add_mesh() returned
  // Replaces the environment by a lat-long picture of linear radiance, until a setting `env` asks for another.
  void set_environment(const Texels& radiance, double intensity = 1.0, double degrees = 0.0);
  std::vector<Redone> update();

  // Renders a picture. Throws Error.
  Result render(const Settings& settings = {}, const Hooks& hooks = {});
  Result render(const Camera& camera, const Settings& settings = {}, const Hooks& hooks = {});

private:
  std::shared_ptr<SessionState> state_;
};

// Loads the scene, renders one picture and forgets the scene: `wavepath render`.
WAVEPATH_API Result render(const Scene& scene, const Settings& settings = {}, const Hooks& hooks = {});

} // namespace wavepath_v0
