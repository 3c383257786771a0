// Reads cube maps of image-based lights and resamples them; see image_light.h.
#include "host/scene/gltf/image_light.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>
#include <glm/gtc/quaternion.hpp>

#include "host/base/memory.h"
#include "host/codecs/srgb.h"
#include "host/scene/gltf/image.h"
#include "host/scene/gltf/nodes.h"
#include "host/scene/gltf/texture.h"
#include "host/scene/lat_long.h"

namespace wavepath::gltf {
namespace {

constexpr std::size_t kFaces = 6;
constexpr std::uint32_t kMostWidth = 8192;

using Faces = std::vector<std::vector<glm::vec3>>;

// Face that a direction leaves by, and the place there: x to the right and y down, both in [-1, 1].
struct FacePlace {
  std::size_t face = 0;
  double x = 0.0, y = 0.0;
};

FacePlace face_of(const glm::dvec3& d) {
  const glm::dvec3 size = glm::abs(d);
  if (size.x >= size.y && size.x >= size.z)
    return {d.x > 0.0 ? 0u : 1u, (d.x > 0.0 ? d.z : -d.z) / size.x, -d.y / size.x};
  if (size.y >= size.z) return {d.y > 0.0 ? 2u : 3u, -d.x / size.y, (d.y > 0.0 ? d.z : -d.z) / size.y};
  return {d.z > 0.0 ? 4u : 5u, (d.z > 0.0 ? -d.x : d.x) / size.z, -d.y / size.z};
}

// Bilinear within a face.
glm::dvec3 look_up(const Faces& faces, std::uint32_t size, const glm::dvec3& direction) {
  FacePlace place = face_of(direction);
  place.x = -place.x, place.y = -place.y; // as files have them, which lie upside down
  const auto along = [&](double position) { return std::clamp(0.5 * (position + 1.0) * size - 0.5, 0.0, size - 1.0); };
  const double x = along(place.x), y = along(place.y);
  const auto x0 = static_cast<std::size_t>(x), y0 = static_cast<std::size_t>(y);
  const std::size_t x1 = std::min<std::size_t>(x0 + 1, size - 1), y1 = std::min<std::size_t>(y0 + 1, size - 1);
  const auto texel = [&](std::size_t column, std::size_t row) {
    return glm::dvec3(faces[place.face][row * size + column]);
  };
  const double fx = x - static_cast<double>(x0), fy = y - static_cast<double>(y0);
  return glm::mix(glm::mix(texel(x0, y0), texel(x1, y0), fx), glm::mix(texel(x0, y1), texel(x1, y1), fx), fy);
}

// Values of a KTX2 file as they are. Else colours, of a JPEG or of a PNG of three channels as they are, those of four
// channels divided by the last (RGBD).
std::vector<glm::vec3> radiance_of(const TextureImage& face) {
  const Image& image = face.image;
  const std::size_t count = std::size_t{image.width} * image.height;
  std::vector<glm::vec3> radiance(count);
  const auto value = [&](std::size_t i) {
    return image.floats.empty() ? static_cast<float>(image.bytes[i]) / 255.0f : image.floats[i];
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (face.holds_values) {
      radiance[i] = {value(4 * i), value(4 * i + 1), value(4 * i + 2)};
      continue;
    }
    const float divisor = std::max(value(4 * i + 3), 1.0f / 255.0f);
    for (std::size_t c = 0; c < 3; ++c)
      radiance[i][static_cast<int>(c)] = static_cast<float>(linear_from_srgb(value(4 * i + c)) / divisor);
  }
  return radiance;
}

const tinygltf::Value* chosen_light(const Document& document, const std::string& request) {
  const std::optional<std::size_t> scene = scene_index(document, request);
  if (!scene) return nullptr;
  const auto& extensions = document.model.scenes[*scene].extensions;
  const auto found = extensions.find("EXT_lights_image_based"),
             all = document.model.extensions.find(found == extensions.end() ? "" : found->first);
  if (found == extensions.end() || all == document.model.extensions.end()) return nullptr;
  return &all->second.Get("lights").Get(static_cast<std::size_t>(found->second.Get("light").GetNumberAsInt()));
}

} // namespace

Environment environment_of_cube(const Faces& faces, std::uint32_t size, const glm::dmat3& world_from_light) {
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  environment.width = std::min(4 * size, kMostWidth);
  environment.height = environment.width / 2;
  environment.map.resize(std::size_t{environment.width} * environment.height);
  const glm::dmat3 light_from_world = glm::transpose(world_from_light);
  tbb::parallel_for(std::uint32_t{0}, environment.height, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < environment.width; ++x) {
      glm::dvec3 sum(0.0);
      for (int part = 0; part < 4; ++part) { // texels of the corners of a face are smaller than those of the map
        const glm::dvec2 uv((x + 0.25 + 0.5 * (part & 1)) / environment.width,
                            (y + 0.25 + 0.5 * (part >> 1)) / environment.height);
        sum += look_up(faces, size, light_from_world * environment_direction(uv, 0.0));
      }
      environment.map[std::size_t{y} * environment.width + x] = glm::vec3(0.25 * sum);
    }
  });
  return environment;
}

Environment read_image_light(Document& document, const std::string& request) {
  const tinygltf::Value* light = chosen_light(document, request);
  if (!light) return {};
  const std::string what = "an image-based light";
  const tinygltf::Value& levels = light->Get("specularImages");
  if (levels.ArrayLen() == 0 || levels.Get(0).ArrayLen() != kFaces) document.fail(what + " does not have six faces");
  ImageMap images;
  for (std::size_t i = 0; i < kFaces; ++i)
    images.sources.push_back(static_cast<std::size_t>(levels.Get(0).Get(i).GetNumberAsInt()));
  const std::vector<TextureImage> decoded = decode_images(image_files(document, images));
  const std::uint32_t size = decoded[0].image.width;
  Faces faces;
  for (const TextureImage& face : decoded) {
    if (face.image.width != size || face.image.height != size)
      document.fail(what + " has faces that are not squares of one size");
    faces.push_back(radiance_of(face));
  }
  glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
  if (light->Has("rotation")) {
    const auto part = [&](std::size_t i) { return light->Get("rotation").Get(i).GetNumberAsDouble(); };
    const glm::dquat given(part(3), part(0), part(1), part(2));
    if (glm::length(given) > 0.0) rotation = glm::normalize(given);
  }
  const double intensity = light->Has("intensity") ? light->Get("intensity").GetNumberAsDouble() : 1.0;
  if (!(intensity >= 0.0 && intensity < 1e30)) document.fail(what + " has no intensity that light can have");
  require_memory(document.file, what, std::uint64_t{16} * size * size * sizeof(glm::vec3), "use smaller images");
  Environment environment = environment_of_cube(faces, size, glm::mat3_cast(rotation));
  environment.radiance = glm::vec3(static_cast<float>(intensity));
  return environment;
}

} // namespace wavepath::gltf
