#include "host/convert/convert.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/shell_quote.h"
#include "host/convert/described.h"
#include "host/convert/environment.h"
#include "host/convert/mitsuba_scene.h"
#include "host/convert/pbrt_scene.h"
#include "host/convert/write_gltf.h"
#include "host/picture/files/picture_io.h"

namespace wavepath::convert {
namespace {

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string beside(const std::string& output, const char* ending) {
  const std::filesystem::path path(output);
  return (path.parent_path() / path.stem()).string() + ending;
}

Description read_scene(const std::string& input) {
  const std::string extension = extension_of(input);
  if (extension == ".pbrt") return read_pbrt(input);
  if (extension == ".xml") return read_mitsuba(input);
  throw UsageError(input, "is neither a .pbrt nor an .xml file", "give a scene of pbrt-v4 or Mitsuba 3");
}

Picture to_picture(const Environment& map) {
  Picture picture{map.width, map.height, {}};
  constexpr const char* kNames[] = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    Channel channel{kNames[c], {}};
    for (std::size_t i = c; i < map.pixels.size(); i += 3) channel.values.push_back(map.pixels[i]);
    picture.channels.push_back(std::move(channel));
  }
  return picture;
}

std::string render_command(const Description& scene, const std::string& output, const std::string& map) {
  std::string command = "wavepath render " + shell_quoted(output);
  if (scene.width > 0) command += fmt::format(" --size {}x{}", scene.width, scene.height);
  if (!scene.environment)
    command += " --env black";
  else if (!map.empty())
    command += " --env " + shell_quoted(map);
  else
    command += fmt::format(" --env {:.6g},{:.6g},{:.6g}", scene.environment->color.x, scene.environment->color.y,
                           scene.environment->color.z);
  if (scene.camera && scene.camera->aperture > 0.0)
    command += fmt::format(" --aperture {:.6g} --focus {:.6g}", 2.0 * scene.camera->aperture, scene.camera->focus);
  // Backs of lamps that shine from one side are visible, and dark.
  const auto shines_from_one_side = [](const Material& material) {
    return !material.double_sided && material.emission.factor != glm::dvec3(0.0);
  };
  if (std::ranges::any_of(scene.materials, shines_from_one_side)) command += " --cull none";
  if (scene.max_depth >= 0) command += fmt::format(" --max-depth {}", scene.max_depth);
  if (scene.film_gain > 0.0 && std::abs(scene.film_gain - 1.0) > 1e-6)
    command += fmt::format(" --exposure {:.6g}", std::log2(scene.film_gain));
  return command + " -o " + shell_quoted(beside(output, ".exr"));
}

void count(const Description& scene, Converted& result) {
  result.shapes = scene.shapes.size();
  result.instances = scene.uses.size();
  result.lights = scene.lights.size();
  for (const Shape& shape : scene.shapes) result.triangles += scene.meshes[shape.mesh].indices.size() / 3;
  for (const std::vector<Shape>& group : scene.groups)
    for (const Shape& shape : group) result.triangles += scene.meshes[shape.mesh].indices.size() / 3;
}

} // namespace

std::vector<std::string> files_of(const std::string& output) {
  std::vector<std::string> files = {output, beside(output, ".env.exr"), beside(output, ".nvdb")};
  if (extension_of(output) == ".gltf") files.push_back(beside(output, ".bin"));
  return files;
}

Converted convert_scene(const std::string& input, const std::string& output) {
  const bool is_glb = extension_of(output) == ".glb";
  if (!is_glb && extension_of(output) != ".gltf")
    throw UsageError(output, "is neither a .glb nor a .gltf file", "name the output so");
  require_writable(output);
  Description scene = read_scene(input);
  Converted result;
  const std::string binary = is_glb ? "" : beside(output, ".bin");
  const std::string voxels = scene.volume ? beside(output, ".nvdb") : "";
  if (scene.volume) scene.volume->uri = std::filesystem::path(voxels).filename().string();
  const GltfText text = to_gltf(scene, output, is_glb ? "" : std::filesystem::path(binary).filename().string());
  std::string map;
  if (scene.environment && !scene.environment->pixels.empty()) {
    move_environment(*scene.environment, scene.root);
    map = beside(output, ".env.exr");
    require_writable(map);
  }
  // All that may fail for want of room happens before the first file takes its name.
  AtomicFile file(output);
  if (is_glb) {
    const std::vector<std::uint8_t> bytes = to_glb(text);
    file.write(bytes.data(), bytes.size());
  } else {
    file.write(text.json.data(), text.json.size());
  }
  std::optional<AtomicFile> data;
  if (!is_glb && !text.binary.empty()) data.emplace(binary).write(text.binary.data(), text.binary.size());
  if (!map.empty()) write_picture(map, to_picture(*scene.environment), {}, {});
  std::optional<AtomicFile> grids;
  if (scene.volume) grids.emplace(voxels).write(scene.volume->file.data(), scene.volume->file.size());
  if (grids) grids->commit();
  if (data) data->commit();
  file.commit();
  result.files = {output};
  if (data) result.files.push_back(binary);
  if (grids) result.files.push_back(voxels);
  if (!map.empty()) result.files.push_back(map);
  result.format = scene.format;
  result.command = render_command(scene, output, map);
  result.losses = scene.losses;
  result.materials = scene.materials.size();
  result.images = scene.images.all().size();
  count(scene, result);
  return result;
}

} // namespace wavepath::convert
