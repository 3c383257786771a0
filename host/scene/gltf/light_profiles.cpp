// Reads the profiles that nodes show, each once; see light_profiles.h.
#include "host/scene/gltf/light_profiles.h"

#include <algorithm>

#include "host/scene/gltf/buffers.h"
#include "host/scene/gltf/uri.h"
#include "host/scene/gltf/views.h"
#include "host/scene/ies.h"

namespace wavepath::gltf {
namespace {

std::vector<std::uint8_t> profile_bytes(Document& document, const Source& source, const std::string& what) {
  if (source.view >= 0) {
    const Bytes bytes = view_bytes(document, static_cast<std::size_t>(source.view));
    return {bytes.begin(), bytes.end()};
  }
  if (source.uri.empty()) document.fail(what + " has neither a URI nor a buffer view");
  return uri_bytes(document, what, source.uri, 0);
}

ProfileMap::Read read_profile(Document& document, Scene& scene, std::size_t index) {
  const Source& source = document.profiles[index];
  const std::string what = "IES profile " + std::to_string(index);
  const std::vector<std::uint8_t> bytes = profile_bytes(document, source, what);
  IesFile file = read_ies(document.file, what, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (file.type != 'C') {
    scene.warnings.add(std::string("lamps whose IES profile has photometry of type ") + file.type +
                       " left out: wavepath reads type C");
    return {};
  }
  file.profile.name = source.name;
  scene.profiles.push_back(std::move(file.profile));
  return {static_cast<std::uint32_t>(scene.profiles.size() - 1), file.candela};
}

} // namespace

std::optional<PunctualLight> read_profile_light(Document& document, Scene& scene, ProfileMap& map,
                                                const tinygltf::Node& node) {
  const auto extension = node.extensions.find("EXT_lights_ies");
  if (extension == node.extensions.end()) return {};
  const tinygltf::Value& value = extension->second;
  const auto index = static_cast<std::size_t>(value.Get("light").GetNumberAsInt());
  auto found = map.read.find(index);
  if (found == map.read.end()) found = map.read.emplace(index, read_profile(document, scene, index)).first;
  if (found->second.index == kNoIndex) return {};
  PunctualLight light;
  light.name = !document.profiles[index].name.empty() ? document.profiles[index].name : node.name;
  light.profile = found->second.index;
  const double multiplier = value.Has("multiplier") ? value.Get("multiplier").GetNumberAsDouble() : 1.0;
  glm::dvec3 color(1.0);
  for (std::size_t i = 0; i < 3 && value.Has("color"); ++i)
    color[static_cast<int>(i)] = value.Get("color").Get(i).GetNumberAsDouble();
  if (multiplier < 0.0 || color != glm::clamp(color, 0.0, 1.0))
    scene.warnings.add("colour or multiplier of an IES lamp outside its range, clamped");
  light.intensity = glm::vec3(glm::clamp(color, 0.0, 1.0) * std::max(multiplier, 0.0) * found->second.candela);
  return light;
}

} // namespace wavepath::gltf
