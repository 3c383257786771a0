// Reads a glTF 2.x file (.gltf with what it refers to, or .glb) into a Scene: everything checked, decoded and posed.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "host/scene/scene.h"

namespace wavepath {

// Called when the scene is complete except for the contents of its images, which are still being decoded.
using SceneDescribed = std::function<void(Scene& scene)>;

struct LoadOptions {
  std::string scene;     // name or index; empty = the file's default scene, else its first one
  std::string animation; // name or index; empty = the pose at rest
  double at = 0.0;       // seconds into the animation, clamped to its key frames
  // Instead of `at`: when the shutter opens and closes. Cameras and lights stay as they are when it opens.
  std::optional<std::pair<double, double>> shutter{};
  std::string variant{};        // name of KHR_materials_variants; empty = the materials that the file shows without one
  bool replaces_volume = false; // the caller has a volume, in place of one of the file
  bool keeps_hidden = false; // materials of hidden nodes and of other variants are read too, so that they can be shown
};

// Throws Error that names the file, what is wrong with it and what to do. What is ignored or repaired is counted in
// Scene::warnings. Meshes, materials and images that the chosen scene does not use are neither read nor decoded.
Scene load_gltf(const std::filesystem::path& path, const LoadOptions& options = {},
                const SceneDescribed& described = {});

// A file that stays open, so that its scene can be posed at one moment after another. Throws Error.
class GltfFile {
public:
  explicit GltfFile(const std::filesystem::path& path);
  ~GltfFile();
  GltfFile(const GltfFile&) = delete;

  // As load_gltf().
  Scene load(const LoadOptions& options = {}, const SceneDescribed& described = {});
  // The scene at another moment, or of another variant. `before`: what load() or pose() gave last, whose images,
  // materials and meshes that keep their shape go over; what others added to its materials, meshes, instances and
  // lights since does not. Without an environment. `options` are those of load() but for the moment.
  Scene pose(const LoadOptions& options, Scene before);
  // Replaces what the file says of a node from the next pose() on: its matrix, as glTF has it, also where an animation
  // moves it; and whether it is visible. Empty: as the file has it. `node` must exist.
  void set_matrix(std::size_t node, const std::optional<glm::dmat4>& matrix);
  void set_visible(std::size_t node, bool is_visible);
  glm::dmat4 matrix(std::size_t node) const;
  bool is_visible(std::size_t node) const; // its own word; a node above it may hide it
  std::size_t node_count() const;
  // The next pose() reads meshes anew: materials that were changed read other streams of theirs.
  void forget_meshes();
  // Materials of the file that the scene has, before those that others added.
  std::size_t material_count() const;
  // Whether the scene that pose() gave last has every instance and vertex where the one before had it; and whether it
  // has the same materials.
  bool is_still() const;
  bool keeps_materials() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace wavepath
