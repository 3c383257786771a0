#include "host/scene/scene_hash.h"

#include <cstring>
#include <span>

namespace wavepath {
namespace {

class Hash {
public:
  // Values whose bytes all count: no padding, no pointers.
  template <class T>
  void add(const T& value) {
    add_bytes(&value, sizeof(T));
  }
  template <class T>
  void add_all(const std::vector<T>& values) {
    add(values.size());
    add_bytes(values.data(), values.size() * sizeof(T));
  }
  std::uint64_t value() const { return state_; }

private:
  // Eight bytes at a time: multiply and fold, as the finalizer of MurmurHash3 does.
  void add_word(std::uint64_t word) {
    state_ = (state_ ^ word) * 0xff51afd7ed558ccdull;
    state_ ^= state_ >> 32;
  }
  void add_bytes(const void* data, std::size_t size) {
    const char* bytes = static_cast<const char*>(data);
    for (; size >= 8; bytes += 8, size -= 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes, 8);
      add_word(word);
    }
    std::uint64_t rest = 0;
    if (size > 0) std::memcpy(&rest, bytes, size);
    add_word(rest << 8 | size);
  }

  std::uint64_t state_ = 0x9e3779b97f4a7c15ull;
};

void add(Hash& hash, const TextureSlot& slot) {
  hash.add(slot.image);
  if (!slot.present()) return;
  hash.add(static_cast<std::uint32_t>(slot.wrap_u) | static_cast<std::uint32_t>(slot.wrap_v) << 2 | slot.nearest << 4 |
           slot.srgb << 5 | slot.uv_set << 6);
  hash.add(slot.uv_matrix);
  hash.add(slot.uv_offset);
}

void add(Hash& hash, const Material& m) {
  hash.add(m.base_color);
  for (const float value : {m.metallic, m.roughness, m.normal_scale, m.alpha_cutoff, m.ior, m.specular, m.transmission})
    hash.add(value);
  for (const glm::vec3& value : {m.emission, m.specular_color, m.attenuation}) hash.add(value);
  hash.add(static_cast<std::uint32_t>(m.alpha_mode) | m.double_sided << 2 | m.unlit << 3 | m.volume << 4);
  for (const TextureSlot* slot :
       {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emission_texture,
        &m.specular_texture, &m.specular_color_texture, &m.transmission_texture})
    add(hash, *slot);
}

void add(Hash& hash, const Mesh& mesh) {
  hash.add_all(mesh.positions);
  hash.add_all(mesh.normals);
  hash.add_all(mesh.tangents);
  for (const auto& uvs : mesh.uvs) hash.add_all(uvs);
  hash.add_all(mesh.colors);
  hash.add_all(mesh.indices);
  for (const Primitive& p : mesh.primitives) {
    for (const std::uint32_t value : {p.first_index, p.index_count, p.material}) hash.add(value);
    hash.add(std::uint32_t{p.has_normals});
  }
}

void add(Hash& hash, const PunctualLight& light) {
  hash.add(static_cast<std::uint32_t>(light.kind));
  hash.add(light.intensity);
  hash.add(light.position);
  hash.add(light.direction);
  hash.add(light.inner_cone);
  hash.add(light.outer_cone);
}

} // namespace

std::uint64_t hash_scene(const Scene& scene) {
  Hash hash;
  for (const Image& image : scene.images) {
    hash.add(std::uint64_t{image.width} << 32 | image.height);
    hash.add_all(image.bytes);
    hash.add_all(image.floats);
  }
  for (const Material& material : scene.materials) add(hash, material);
  for (const Mesh& mesh : scene.meshes) add(hash, mesh);
  for (const Instance& instance : scene.instances) {
    hash.add(instance.mesh);
    hash.add(instance.world_from_object);
  }
  for (const PunctualLight& light : scene.lights) add(hash, light);
  const Environment& environment = scene.environment;
  hash.add(environment.radiance);
  hash.add(std::uint64_t{environment.width} << 32 | environment.height);
  hash.add_all(environment.map);
  hash.add(environment.rotation);
  return hash.value();
}

} // namespace wavepath
