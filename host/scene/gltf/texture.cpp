// Resolves texture, sampler and image of a textureInfo, with KHR_texture_transform, KHR_texture_basisu
// and EXT_texture_webp.
#include "host/scene/gltf/texture.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include <tbb/parallel_for.h>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/base/overloaded.h"
#include "host/scene/gltf/image.h"
#include "host/scene/gltf/property.h"
#include "host/scene/gltf/uri.h"
#include "host/scene/gltf/views.h"

namespace wavepath::gltf {
namespace {

using nlohmann::json;

std::size_t image_of_texture(const Document& document, int index) {
  const tinygltf::Texture& texture = document.model.textures[static_cast<std::size_t>(index)];
  for (const char* extension : {"KHR_texture_basisu", "EXT_texture_webp"}) {
    const auto found = texture.extensions.find(extension);
    if (found != texture.extensions.end() && found->second.Has("source"))
      return static_cast<std::size_t>(found->second.Get("source").GetNumberAsInt());
  }
  if (texture.source >= 0) return static_cast<std::size_t>(texture.source);
  std::string needed;
  for (const auto& [name, value] : texture.extensions) needed += (needed.empty() ? "" : ", ") + shown(name);
  const std::string what = "texture " + std::to_string(index);
  if (needed.empty()) document.fail(what + " has no image");
  document.fail(what + " needs " + needed + ", which wavepath does not support",
                "export it with PNG, JPEG, WebP or KTX2 images");
}

// Images that share a file or a buffer view are one image.
std::uint32_t use_image(const Document& document, ImageMap& images, std::size_t image) {
  const Source& source = document.images[image];
  const bool shared_file = source.view < 0 && !is_data_uri(source.uri);
  const std::string key = shared_file        ? source.uri
                          : source.view >= 0 ? ":" + std::to_string(source.view)
                                             : "#" + std::to_string(image);
  const auto [found, is_new] = images.index_of.emplace(key, static_cast<std::uint32_t>(images.sources.size()));
  if (is_new) images.sources.push_back(image);
  return found->second;
}

Wrap to_wrap(const Document& document, int mode) {
  switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return Wrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::clamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::mirror;
    default:
      document.fail("a sampler has unknown wrap mode " + std::to_string(mode));
  }
}

glm::vec2 pair(const json& transform, const char* name, glm::vec2 otherwise) {
  const auto found = transform.find(name);
  return found == transform.end() ? otherwise : glm::vec2((*found)[0].get<double>(), (*found)[1].get<double>());
}

void apply_transform(TextureSlot& slot, Warnings& warnings, const json& transform) {
  const glm::vec2 scale = pair(transform, "scale", glm::vec2(1.0f));
  const double angle = transform.value("rotation", 0.0);
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  const glm::vec2 offset = pair(transform, "offset", glm::vec2(0.0f));
  if (!std::isfinite(scale.x + scale.y) || !std::isfinite(offset.x + offset.y)) {
    warnings.add("texture transform of numbers too large for floats ignored");
    return;
  }
  slot.uv_offset = offset;
  // Counter-clockwise as seen, and v points down: u' = cu + sv, v' = cv - su.
  slot.uv_matrix = glm::mat2(c, -s, s, c) * glm::mat2(scale.x, 0.0f, 0.0f, scale.y);
}

// The slot decides how texels are read, as glTF asks; files of KTX2 should say the same.
void warn_of_disagreement(Warnings& warnings, const TextureImage& file, const TextureSlot& slot) {
  if (!file.transfer) return;
  if (*file.transfer != ktx::Transfer::other && (*file.transfer == ktx::Transfer::srgb) == slot.srgb) return;
  const char* said = *file.transfer == ktx::Transfer::srgb     ? "sRGB"
                     : *file.transfer == ktx::Transfer::linear ? "linear"
                                                               : "of another transfer function";
  warnings.add("image '" + file.image.name + "' says that it is " + said + ", but a material reads it as " +
               (slot.srgb ? "sRGB" : "linear"));
}

} // namespace

TextureSlot read_texture(const Document& document, ImageMap& images, Warnings& warnings, const json& info, bool srgb) {
  TextureSlot slot;
  const json* transform = find_property(info, "extensions.KHR_texture_transform");
  slot.uv_set = info.value("texCoord", 0u);
  if (transform) slot.uv_set = transform->value("texCoord", slot.uv_set);
  slot.srgb = srgb;
  const int texture = info["index"];
  slot.image = use_image(document, images, image_of_texture(document, texture));
  const int sampler = document.model.textures[static_cast<std::size_t>(texture)].sampler;
  if (sampler >= 0) {
    const auto& source = document.model.samplers[static_cast<std::size_t>(sampler)];
    slot.wrap_u = to_wrap(document, source.wrapS);
    slot.wrap_v = to_wrap(document, source.wrapT);
    slot.nearest = source.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
  }
  if (transform) apply_transform(slot, warnings, *transform);
  return slot;
}

std::vector<ImageFile> image_files(Document& document, const ImageMap& images) {
  std::vector<ImageFile> files;
  for (const std::size_t image : images.sources) {
    const Source& source = document.images[image];
    std::string name = !source.name.empty() ? source.name : source.uri;
    if (name.empty() || is_data_uri(name)) name = std::to_string(image);
    files.push_back({document.file, shown(name), image_bytes(document, image)});
  }
  return files;
}

std::vector<TextureImage> decode_images(const std::vector<ImageFile>& files) {
  std::vector<TextureImage> decoded(files.size());
  std::vector<std::exception_ptr> failures(files.size());
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    try {
      decoded[i] = decode_image(files[i].document, files[i].name, files[i].bytes);
    } catch (...) {
      failures[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  return decoded;
}

bool take_images(Scene& scene, std::vector<TextureImage> images) {
  std::vector<bool> limited(images.size()); // read as something of which 1 is the most
  for (Material& material : scene.materials) {
    const auto visit_row = [&](const MaterialTexture& row) {
      TextureSlot& slot = material.*row.field;
      if (!slot.present()) return;
      const TextureImage& file = images[slot.image];
      if (file.holds_values) {
        slot.srgb = slot.srgb && file.transfer == ktx::Transfer::srgb;
        if (row.field != &Material::emission_texture) limited[slot.image] = true;
      }
      warn_of_disagreement(scene.warnings, file, slot);
    };
    visit_material_fields(Overloaded{visit_row, [](const auto&) {}});
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    TextureImage& file = images[i];
    const std::string what = "image '" + file.image.name + "' ";
    if (file.premultiplied)
      scene.warnings.add(what + "has colours multiplied by alpha, which glTF forbids; read as they are");
    if (file.bad_values > 0)
      scene.warnings.add("values of " + what + "that are negative, not finite or beyond 65504, replaced",
                         file.bad_values);
    for (std::size_t k = 0; file.holds_values && k < file.image.floats.size(); ++k)
      if (limited[i] || k % 4 == 3) file.image.floats[k] = std::min(file.image.floats[k], 1.0f);
    scene.images.push_back(std::move(file.image));
  }
  return std::ranges::any_of(images, &TextureImage::holds_values);
}

} // namespace wavepath::gltf
