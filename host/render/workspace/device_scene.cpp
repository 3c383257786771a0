#include "host/render/workspace/device_scene.h"

#include <algorithm>
#include <cstring>
#include <span>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/codecs/srgb.h"
#include "host/gpu/commands.h"
#include "host/render/workspace/query_scene.h"
#include "kernels/base/light_tree_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/volume/voxel_types.h"

namespace wavepath {
namespace {

// bvh/ knows nothing of devices; what it writes is what the kernels read.
static_assert(sizeof(bvh::WideNode) == 16 * gpu::kNodeTexels);
static_assert(bvh::kCellBias == gpu::kCellBias && bvh::kAbsent == gpu::kNone &&
              bvh::kMaxLeafItems == gpu::kLeafFirstMask + 1);

// Byte value to linear radiance.
std::vector<float> srgb_decoding() {
  std::vector<float> table;
  for (int byte = 0; byte < 256; ++byte) table.push_back(static_cast<float>(linear_from_srgb(byte / 255.0)));
  return table;
}

template <class T>
std::uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

// Checks one array of the scene against the device's limits; the message is in the user's words.
void check_fits(const DeviceInfo& info, const char* what, std::uint64_t bytes, std::uint64_t limit) {
  if (bytes > limit)
    throw Error(info.name,
                fmt::format("the scene's {} take {:.0f} MiB, its limit is {:.0f} MiB", what, bytes / 1048576.0,
                            limit / 1048576.0),
                "simplify the scene or choose another device with --device");
}

// Triangles, and behind them how far their corners move, where any do.
std::vector<gpu::Triangle> with_motions(const PackedScene& scene) {
  std::vector<gpu::Triangle> all = scene.triangles;
  all.insert(all.end(), scene.motions.begin(), scene.motions.end());
  return all;
}

// Lights, and behind them the parts of their triangles.
std::vector<std::uint32_t> light_words(const PackedScene& scene) {
  constexpr std::size_t kWords = sizeof(gpu::Light) / sizeof(std::uint32_t);
  std::vector<std::uint32_t> words(scene.lights.size() * kWords + (scene.light_parts.size() + 3) / 4 * 4);
  if (!scene.lights.empty()) std::memcpy(words.data(), scene.lights.data(), scene.lights.size() * sizeof(gpu::Light));
  std::ranges::copy(scene.light_parts, words.begin() + static_cast<std::ptrdiff_t>(scene.lights.size() * kWords));
  return words;
}

// Materials, behind them their layers, behind these the albedo tables.
std::vector<std::byte> material_bytes(const PackedScene& scene) {
  std::vector<std::byte> all;
  const auto add = [&](const auto& records) {
    const auto bytes = std::as_bytes(std::span(records));
    all.insert(all.end(), bytes.begin(), bytes.end());
  };
  add(scene.materials), add(scene.layers), add(scene.albedo_tables);
  return all;
}

std::vector<Buffer> upload_pages(Device& device, std::span<const std::uint32_t> texels) {
  constexpr std::size_t kPage = std::size_t{1} << gpu::kTexelPageShift;
  std::vector<Buffer> pages;
  for (std::size_t at = 0; at < texels.size() || at == 0; at += kPage) {
    const std::span page = texels.subspan(at, std::min(kPage, texels.size() - at));
    pages.emplace_back(device, page.size_bytes());
    if (!page.empty()) pages.back().write(page.data(), page.size_bytes());
  }
  return pages;
}

// By bands of rows, so that no more than one of them is on the device twice.
std::unique_ptr<DeviceImage> upload_atlas(Device& device, const Atlas& atlas, bool is_color) {
  const ImageInfo info{.name = is_color ? "colour textures" : "textures of values",
                       .format = is_color ? ImageFormat::rgba8_srgb : ImageFormat::rgba8,
                       .width = atlas.width,
                       .height = atlas.height,
                       .layers = atlas.layers,
                       .sampled = true,
                       .is_array = true};
  auto image = std::make_unique<DeviceImage>(device, info);
  constexpr std::uint32_t kBandTexels = 1u << 22; // 16 MiB
  const std::uint32_t band = std::clamp(kBandTexels / atlas.width, 1u, atlas.height);
  Buffer staged(device, std::uint64_t{band} * atlas.width * sizeof(std::uint32_t));
  Commands commands(device);
  const std::uint32_t* words = atlas.words.data();
  for (std::uint32_t layer = 0; layer < atlas.layers; ++layer)
    for (std::uint32_t y = 0; y < atlas.height; y += band) {
      const std::uint32_t rows = std::min(band, atlas.height - y);
      const std::size_t texels = std::size_t{rows} * atlas.width;
      staged.write(words, texels * sizeof(std::uint32_t));
      words += texels;
      image->copy_from(commands.handle(), staged, {.y = y, .width = atlas.width, .height = rows}, layer);
      commands.submit_and_wait();
      commands.restart(0);
    }
  image->transition(commands.handle(), ImageUse::sampled);
  commands.submit_and_wait();
  return image;
}

// Writes over what the buffer holds if it has this size: fresh memory costs a fault a page.
template <class T>
void renew(Device& device, const std::vector<T>& values, Buffer& buffer) {
  if (!buffer.handle() || buffer.bytes() != bytes_of(values)) {
    buffer = Buffer{}; // makes room first
    buffer = upload(device, values);
  } else if (!values.empty()) {
    buffer.write(values.data(), bytes_of(values));
  }
}

// Writes some of the values over those that the buffer holds.
template <class T>
void rewrite(std::span<const ArrayRange> ranges, const std::vector<T>& values, Buffer& buffer) {
  for (const ArrayRange& range : ranges)
    if (range.count > 0) buffer.write(values.data() + range.first, range.count * sizeof(T), range.first * sizeof(T));
}

// What of a scene on the device goes over to the next one, and what lends it memory of the size that it needs. The rest
// makes room.
DeviceScene take_kept(DeviceScene kept, const PackedScene& scene, const KeptParts& parts) {
  const auto lend = [](Buffer& buffer, std::uint64_t bytes) {
    if (buffer.bytes() != bytes) buffer = Buffer{};
  };
  if (!parts.textures) {
    kept.textures = Buffer{};
    kept.srgb_table = Buffer{};
    kept.texels.clear();
    kept.atlases = {};
  }
  if (!parts.environment) {
    lend(kept.environment, bytes_of(scene.environment));
    lend(kept.environment_ends, bytes_of(scene.environment_ends));
  }
  if (!scene.voxels) kept.volume = Buffer{};
  if (!scene.voxels || !parts.voxels) {
    kept.volume_grid = Buffer{};
    kept.voxels = Buffer{};
  }
  if (!parts.lights) {
    kept.lights = Buffer{};
    kept.light_tree = Buffer{};
  }
  if (!parts.geometry) {
    if (kept.queries) {
      kept.queries.reset();
      kept.nodes = Buffer{};
      kept.instances = Buffer{};
    }
    lend(kept.nodes, bytes_of(scene.nodes));
    lend(kept.instances, bytes_of(scene.instances));
    lend(kept.triangles, bytes_of(scene.triangles) + bytes_of(scene.motions));
    lend(kept.triangle_vertices, bytes_of(scene.triangle_vertices));
    lend(kept.vertex_normals, bytes_of(scene.vertex_normals));
    lend(kept.vertex_uvs, bytes_of(scene.vertex_uvs));
    lend(kept.vertex_colors, bytes_of(scene.vertex_colors));
  }
  return kept;
}

bool any_sampled(const PackedScene& scene) { return !scene.atlases[0].empty() || !scene.atlases[1].empty(); }

} // namespace

AtlasImages upload_atlases(Device& device, const Atlases& atlases) {
  // Not of a side that is a power of two: kernels are warmed up with it (host/scene/pack/atlas.cpp).
  const Atlas dummy{3, 3, 1, std::vector<std::uint32_t>(9)};
  AtlasImages images;
  for (std::size_t i = 0; i < images.size(); ++i)
    images[i] = upload_atlas(device, atlases[i].empty() ? dummy : atlases[i], i == 1);
  return images;
}

std::vector<Binding> atlas_bindings(const AtlasImages& images) {
  std::vector<Binding> bindings;
  for (std::uint32_t i = 0; i < images.size(); ++i)
    bindings.push_back({.slot = gpu::kBindAtlases + i,
                        .kind = BindingKind::sampled_image,
                        .image = images[i].get(),
                        .sampling = {.filter = Filter::linear}});
  return bindings;
}

std::vector<Binding> volume_bindings(const Buffer* volume, const Buffer* grid, const Buffer* voxels) {
  return {{gpu::kBindVolume, BindingKind::texels_rgba32ui, volume},
          {gpu::kBindVolumeGrid, BindingKind::texels_rg32ui, grid},
          {gpu::kBindVoxels, BindingKind::texels_r32f, voxels}};
}

DeviceScene upload_scene(Device& device, const PackedScene& scene, bool by_query) {
  return upload_next_scene(device, scene, by_query, {}, {});
}

DeviceScene upload_next_scene(Device& device, const PackedScene& scene, bool by_query, DeviceScene before,
                              const KeptParts& kept) {
  const DeviceInfo& info = device.info();
  constexpr std::uint64_t kPage = sizeof(std::uint32_t) << gpu::kTexelPageShift;
  const std::uint64_t wide = std::min(16 * info.max_texels(16), info.max_allocation);
  const std::uint64_t page = std::min({4 * info.max_texels(4), info.max_allocation, kPage});
  const std::uint64_t pages = page < kPage || info.has_few_texels ? page : gpu::kTexelPages * kPage;
  const std::uint64_t node_bytes = by_query ? 0 : bytes_of(scene.nodes);
  check_fits(info, "BVH nodes", node_bytes, wide);
  check_fits(info, "triangles", bytes_of(scene.triangles) + bytes_of(scene.motions), wide);
  check_fits(info, "triangle indices", bytes_of(scene.triangle_vertices), wide);
  check_fits(info, "vertices", bytes_of(scene.vertex_normals), wide);
  check_fits(info, "vertex coordinates", bytes_of(scene.vertex_uvs), wide);
  check_fits(info, "vertex colours", bytes_of(scene.vertex_colors), wide);
  check_fits(info, "textures", bytes_of(scene.texels), pages);
  check_fits(info, "uses of textures", bytes_of(scene.textures),
             std::min(16 * info.max_texel_elements, info.max_allocation));
  check_fits(info, "environment texels", bytes_of(scene.environment), wide);
  check_fits(info, "environment distribution", bytes_of(scene.environment_ends),
             std::min(4 * info.max_texels(4), info.max_allocation));
  check_fits(info, "lights", bytes_of(scene.lights) + bytes_of(scene.light_parts), wide);
  check_fits(info, "light tree", bytes_of(scene.light_tree), wide);
  if (scene.voxels) {
    check_fits(info, "voxels", bytes_of(scene.voxels->voxels), std::min(4 * info.max_texels(4), info.max_allocation));
    check_fits(info, "bricks of voxels", bytes_of(scene.voxels->grid),
               std::min(8 * info.max_texels(8), info.max_allocation));
  }
  const std::uint64_t total = node_bytes + bytes_of(scene.triangles) + bytes_of(scene.motions) +
                              bytes_of(scene.triangle_vertices) + bytes_of(scene.vertex_normals) +
                              bytes_of(scene.vertex_uvs) + bytes_of(scene.vertex_colors) + bytes_of(scene.texels) +
                              bytes_of(scene.environment) + bytes_of(scene.environment_ends) + bytes_of(scene.lights) +
                              bytes_of(scene.light_parts) + bytes_of(scene.light_tree) + scene.atlases[0].bytes() +
                              scene.atlases[1].bytes() + (scene.voxels ? scene.voxels->bytes() : 0);
  if (total > info.memory_bytes)
    throw Error(info.name,
                fmt::format("the scene takes {:.0f} MiB, the device has {:.0f} MiB", total / 1048576.0,
                            info.memory_bytes / 1048576.0),
                "simplify the scene or choose another device with --device");

  KeptParts parts = kept;
  if (by_query && !parts.marks) parts.geometry = false; // its instances hold both
  if (by_query || before.queries || !before.triangles.handle() ||
      before.triangles.bytes() != bytes_of(scene.triangles)) // more of them, by splits
    parts.places = false;
  DeviceScene result = take_kept(std::move(before), scene, parts);
  if (parts.places) {
    renew(device, scene.nodes, result.nodes);
    renew(device, scene.instances, result.instances);
    const ArrayRange triangles[] = {parts.moved_triangles};
    rewrite(triangles, scene.triangles, result.triangles);
    if (!scene.triangle_vertices.empty()) rewrite(triangles, scene.triangle_vertices, result.triangle_vertices);
    rewrite(parts.moved_vertices, scene.vertex_normals, result.vertex_normals);
  } else if (!parts.geometry) {
    if (by_query) {
      QueryScene queries = make_query_scene(device, scene);
      result.nodes = upload(device, queries.items);
      result.instances = upload(device, queries.instances);
      result.queries.emplace(std::move(queries.structures));
    } else {
      renew(device, scene.nodes, result.nodes);
      renew(device, scene.instances, result.instances);
    }
    if (scene.moves())
      renew(device, with_motions(scene), result.triangles);
    else
      renew(device, scene.triangles, result.triangles);
    renew(device, scene.triangle_vertices, result.triangle_vertices);
    renew(device, scene.vertex_normals, result.vertex_normals);
    renew(device, scene.vertex_uvs, result.vertex_uvs);
    renew(device, scene.vertex_colors, result.vertex_colors);
  } else if (!kept.marks) {
    renew(device, scene.triangles, result.triangles); // scenes that move keep none
    renew(device, scene.instances, result.instances);
  }
  renew(device, material_bytes(scene), result.materials);
  if (!kept.textures) {
    result.textures = upload(device, scene.textures);
    result.texels = upload_pages(device, scene.texels);
    result.srgb_table = upload(device, scene.texels.empty() ? std::vector<float>{} : srgb_decoding());
    if (any_sampled(scene)) result.atlases = upload_atlases(device, scene.atlases);
  }
  if (!kept.environment) {
    renew(device, scene.environment, result.environment);
    renew(device, scene.environment_ends, result.environment_ends);
  }
  if (scene.voxels) {
    renew(device, std::vector{scene.volume}, result.volume);
    if (!kept.voxels) {
      renew(device, scene.voxels->grid, result.volume_grid);
      renew(device, scene.voxels->voxels, result.voxels);
    }
  }
  if (!kept.lights) {
    result.lights = upload(device, light_words(scene));
    result.light_tree = upload(device, scene.light_tree);
  }
  return result;
}

std::vector<Binding> DeviceScene::bindings() const {
  using enum BindingKind;
  // Where not all of them can be storage blocks, the first ones are: these are the largest of most scenes.
  std::vector<Binding> all = {{gpu::kBindNodes, texels_rgba32ui, &nodes},
                              {gpu::kBindTriangles, texels_rgba32f, &triangles},
                              {gpu::kBindTriangleVertices, texels_rgba32ui, &triangle_vertices},
                              {gpu::kBindVertexNormals, texels_rgba32f, &vertex_normals},
                              {gpu::kBindVertexUvs, texels_rgba32f, &vertex_uvs},
                              {gpu::kBindTexels, texels_r32ui, texels.empty() ? nullptr : &texels.front()},
                              {gpu::kBindEnvironment, texels_rgba32f, &environment},
                              {gpu::kBindEnvironmentEnds, texels_r32ui, &environment_ends},
                              {gpu::kBindInstances, texels_rgba32f, &instances},
                              {gpu::kBindVertexColors, texels_rgba32f, &vertex_colors},
                              {gpu::kBindLights, texels_rgba32ui, &lights},
                              {gpu::kBindLightTree, texels_rgba32ui, &light_tree},
                              {gpu::kBindMaterials, texels_rgba32ui, &materials}};
  // So few that what comes behind the scene, such as trained probabilities of lights, needs the block more.
  all.push_back({.slot = gpu::kBindTextures, .kind = texels_rgba32ui, .buffer = &textures, .is_small = true});
  all.push_back({.slot = gpu::kBindSrgbTable, .kind = texels_r32f, .buffer = &srgb_table, .is_small = true});
  // Kernels that know of more pages than there are never read them. Small texel buffers have one page.
  for (std::uint32_t page = 1; page < gpu::kTexelPages; ++page)
    all.push_back({.slot = gpu::kBindTexelPages + page - 1,
                   .kind = texels_r32ui,
                   .buffer = page < texels.size() ? &texels[page] : &srgb_table,
                   .is_small = true});
  if (volume.handle())
    for (const Binding& binding : volume_bindings(&volume, &volume_grid, &voxels)) all.push_back(binding);
  if (atlases[0])
    for (const Binding& binding : atlas_bindings(atlases)) all.push_back(binding);
  return all;
}

std::uint64_t DeviceScene::bvh_bytes() const {
  return nodes.bytes() + triangles.bytes() + instances.bytes() + (queries ? queries->bytes() : 0);
}

std::uint64_t DeviceScene::other_bytes() const {
  std::uint64_t texel_bytes = 0;
  for (const Buffer& page : texels) texel_bytes += page.bytes();
  for (const auto& atlas : atlases) texel_bytes += atlas ? atlas->bytes() : 0;
  return triangle_vertices.bytes() + vertex_normals.bytes() + vertex_uvs.bytes() + vertex_colors.bytes() +
         materials.bytes() + textures.bytes() + texel_bytes + srgb_table.bytes() + lights.bytes() + light_tree.bytes() +
         environment.bytes() + environment_ends.bytes() + volume.bytes() + volume_grid.bytes() + voxels.bytes();
}

} // namespace wavepath
