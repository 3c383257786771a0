#include "host/passes/passes.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <span>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/integrators/path/first_hits.h"
#include "host/passes/cryptomatte.h"
#include "host/picture/files/picture_io.h"
#include "host/render/settings/pass_names.h"
#include "host/scene/pack/hit_surface.h"

namespace wavepath {
namespace {

constexpr float kNothing = 1e10f; // depth where nothing was hit, as the AOV `depth` has it
constexpr const char* kNearest = "Zmin";
constexpr const char* kObjects = "CryptoObject";
constexpr const char* kMaterials = "CryptoMaterial";
constexpr const char *kNodesText = "wavepath.nodes", *kMaterialsText = "wavepath.materials";

bool wants(const RenderPlan& settings, std::string_view pass) { return std::ranges::count(settings.aovs, pass) > 0; }

std::string node_name(const PackedScene& scene, std::uint32_t node) {
  if (node == kNoIndex) return "ground"; // what staging placed under an asset
  const std::string& name = scene.node_names[node];
  return name.empty() ? fmt::format("node {}", node) : name;
}

std::string material_name(const PackedScene& scene, std::uint32_t material) {
  const std::string& name = scene.material_names[material];
  return name.empty() ? fmt::format("material {}", material) : name;
}

// {"3": "Chair", ...} of ids that pixels may show.
template <class Name>
std::string table_text(const std::vector<std::uint32_t>& ids, Name name) {
  nlohmann::ordered_json table = nlohmann::ordered_json::object();
  for (const std::uint32_t id : ids) table[fmt::format("{}", id)] = name(id);
  return table.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Nodes of the file that pixels may show, ascending; kNoIndex last, if something is shown by none.
std::vector<std::uint32_t> shown_nodes(const PackedScene& scene) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t id = 0; id < scene.instance_nodes.size(); ++id)
    if (id != scene.once_instance) nodes.push_back(scene.instance_nodes[id]);
  for (const NodeRun& run : scene.node_runs) nodes.push_back(run.node);
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

// What one pixel shows at its centre, as values of the channels of a pass. `value(hit, component)`; nothing was hit:
// `nothing`, unless the pass has a value there as well.
struct CentrePass {
  std::string_view name;
  std::vector<std::string> channels;
  float nothing = 0.0f;
  std::function<double(const FirstHit&, int)> value;
  bool of_background = false;
};

// On the side that the ray came from.
glm::dvec3 facing_normal(const PackedScene& scene, const FirstHit& found) {
  const glm::dvec3 normal = geometric_normal(scene, found.hit);
  return glm::dot(normal, glm::dvec3(found.ray.direction)) > 0.0 ? -normal : normal;
}

std::vector<CentrePass> centre_passes(const PackedScene& scene) {
  const auto node = [&scene](const FirstHit& f, int) {
    const std::uint32_t index = node_of(scene, f.hit);
    return index == kNoIndex ? -1.0 : static_cast<double>(index);
  };
  return {
      {"node", {"id.node"}, -1.0f, node},
      {"material", {"id.material"}, -1.0f, [&](const FirstHit& f, int) { return material_of(scene, f.hit); }},
      {"depth0", {"Z0"}, kNothing, [](const FirstHit& f, int) { return f.surface.depth; }},
      {"normal0", {"N0.X", "N0.Y", "N0.Z"}, 0.0f, [](const FirstHit& f, int c) { return f.surface.normal[c]; }},
      {"position0",
       {"P0.X", "P0.Y", "P0.Z"},
       0.0f,
       [&](const FirstHit& f, int c) { return f.surface.position[c] + scene.origin[c]; }},
      {"geometric",
       {"Ng.X", "Ng.Y", "Ng.Z"},
       0.0f,
       [&](const FirstHit& f, int c) { return facing_normal(scene, f)[c]; }},
      {"uv", {"uv.X", "uv.Y"}, 0.0f, [&](const FirstHit& f, int c) { return texture_coordinates(scene, f.hit)[c]; }}};
}

// Names of their channels, and what finds their values, which is called where `pictures` has that picture alone.
std::vector<CentrePass> motion_passes(const PackedScene& scene, const View& view, const glm::uvec2& size,
                                      const MotionPictures& pictures) {
  const auto to = [&scene, &view, &pictures, size](const std::optional<OtherPicture>& other) {
    return [&scene, &view, &pictures, size, &other](const FirstHit& f, int c) {
      return motion_to(*other, pictures, scene, view, size, f)[c];
    };
  };
  return {{kMotionPass, {"motion.X", "motion.Y"}, 0.0f, to(pictures.next), true},
          {kMotionBackPass, {"motionBack.X", "motionBack.Y"}, 0.0f, to(pictures.previous), true}};
}

// Names of what passes through the centres.
std::vector<std::string> channels_of_centres() {
  std::vector<std::string> names;
  const PackedScene none;
  const View view;
  const MotionPictures pictures;
  for (const auto& passes : {centre_passes(none), motion_passes(none, view, {}, pictures)})
    for (const CentrePass& pass : passes) names.insert(names.end(), pass.channels.begin(), pass.channels.end());
  return names;
}

bool needs_surface(std::string_view pass) { return pass == "depth0" || pass == "normal0" || pass == "position0"; }

// What the passes are made from and with.
struct PassTracer {
  Device& device;
  const PackedScene& scene;
  const View& view;
  const RenderPlan& settings;
  const MotionPictures& motion;
  KernelCompiler& kernels;
  SceneOnDevice& shared;
  const std::function<bool()>& progress;

  bool trace(RaysThrough through, HitData data, const std::function<void(const FirstHit&)>& visit) const {
    return trace_first_hits(device, scene, view, settings, through, data, kernels, shared, progress,
                            [&](std::span<const FirstHit> hits) { std::ranges::for_each(hits, visit); });
  }
};

bool add_centre_passes(const PassTracer& tracer, Picture& picture) {
  std::vector<CentrePass> passes = centre_passes(tracer.scene);
  std::ranges::move(
      motion_passes(tracer.scene, tracer.view, {tracer.settings.width, tracer.settings.height}, tracer.motion),
      std::back_inserter(passes));
  std::erase_if(passes, [&](const CentrePass& pass) { return !wants(tracer.settings, pass.name); });
  if (passes.empty()) return true;
  std::vector<Channel> channels;
  for (const CentrePass& pass : passes)
    for (const std::string& channel : pass.channels) {
      channels.push_back({channel, std::vector<float>(std::size_t{picture.width} * picture.height)});
      std::erase_if(picture.channels, [&](const Channel& known) { return known.name == channel; }); // of `ids`
    }
  const bool surface = std::ranges::any_of(passes, needs_surface, &CentrePass::name);
  const bool whole =
      tracer.trace(RaysThrough::centres, surface ? HitData::surface : HitData::geometry, [&](const FirstHit& found) {
        std::size_t channel = 0;
        for (const CentrePass& pass : passes)
          for (int c = 0; c < static_cast<int>(pass.channels.size()); ++c)
            channels[channel++].values[found.pixel] = found.hit.triangle == gpu::kNone && !pass.of_background
                                                          ? pass.nothing
                                                          : static_cast<float>(pass.value(found, c));
      });
  std::ranges::move(channels, std::back_inserter(picture.channels));
  return whole;
}

bool add_coverages(const PassTracer& tracer, Picture& picture) {
  const PackedScene& scene = tracer.scene;
  std::vector<std::string> names, materials;
  const std::vector<std::uint32_t> nodes = shown_nodes(scene);
  for (const std::uint32_t node : nodes) names.push_back(node_name(scene, node));
  for (std::uint32_t i = 0; i < scene.material_names.size(); ++i) materials.push_back(material_name(scene, i));

  std::vector<SampleCounts> of_nodes(std::size_t{picture.width} * picture.height), of_materials(of_nodes.size());
  const bool whole = tracer.trace(RaysThrough::samples, HitData::geometry, [&](const FirstHit& found) {
    if (found.hit.triangle == gpu::kNone) return;
    const auto node = std::ranges::lower_bound(nodes, node_of(scene, found.hit));
    ++of_nodes[found.pixel][static_cast<std::uint32_t>(node - nodes.begin())];
    ++of_materials[found.pixel][material_of(scene, found.hit)];
  });
  const std::uint32_t samples = tracer.settings.last_sample - tracer.settings.first_sample;
  add_cryptomatte(picture, kObjects, of_nodes, names, samples);
  add_cryptomatte(picture, kMaterials, of_materials, materials, samples);
  return whole;
}

// The nearest hit of all samples. Depths of parts of a render join exactly.
bool add_nearest(const PassTracer& tracer, Picture& picture) {
  std::vector<float> nearest(std::size_t{picture.width} * picture.height, kNothing);
  const bool whole = tracer.trace(RaysThrough::samples, HitData::surface, [&](const FirstHit& found) {
    if (found.hit.triangle == gpu::kNone) return;
    nearest[found.pixel] = std::min(nearest[found.pixel], static_cast<float>(found.surface.depth));
  });
  picture.channels.push_back({kNearest, std::move(nearest)});
  return whole;
}

} // namespace

bool add_passes(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                const MotionPictures& motion, KernelCompiler& kernels, SceneOnDevice& shared,
                const std::function<bool()>& progress, Picture& picture) {
  const PassTracer tracer{device, scene, view, settings, motion, kernels, shared, progress};
  bool whole = add_centre_passes(tracer, picture);
  if (wants(settings, "node")) {
    std::vector<std::uint32_t> nodes = shown_nodes(scene);
    std::erase(nodes, kNoIndex); // which has no id
    picture.texts.emplace_back(kNodesText, table_text(nodes, [&](std::uint32_t id) { return node_name(scene, id); }));
  }
  if (wants(settings, "material")) {
    std::vector<std::uint32_t> all(scene.material_names.size());
    std::iota(all.begin(), all.end(), 0u);
    picture.texts.emplace_back(kMaterialsText,
                               table_text(all, [&](std::uint32_t id) { return material_name(scene, id); }));
  }
  if (wants(settings, "cryptomatte")) whole &= add_coverages(tracer, picture);
  if (wants(settings, "depth_min")) whole &= add_nearest(tracer, picture);
  return whole;
}

bool has_passes(const Picture& picture) {
  const auto is_known = [&](const std::string& channel) { return find_channel(picture, channel) != nullptr; };
  return std::ranges::any_of(channels_of_centres(), is_known) || has_cryptomatte(picture, kObjects) ||
         is_known(kNearest);
}

void join_passes(JoinedPasses& joined, const Picture& part, std::uint32_t samples) {
  const bool is_first = !joined.has_parts;
  joined.has_parts = true;
  if (is_first)
    for (const std::string& channel : channels_of_centres())
      if (const Channel* known = find_channel(part, channel)) joined.centres.push_back(*known);
  for (const char* layer : {kObjects, kMaterials}) {
    if (!has_cryptomatte(part, layer)) {
      joined.layers.erase(layer);
      continue;
    }
    if (is_first) joined.layers[layer];
    if (const auto known = joined.layers.find(layer); known != joined.layers.end())
      join_cryptomatte(known->second, layer, part, samples);
  }
  const Channel* nearest = find_channel(part, kNearest);
  if (!nearest)
    joined.nearest.reset();
  else if (is_first)
    joined.nearest = *nearest;
  else if (joined.nearest)
    for (std::size_t i = 0; i < nearest->values.size(); ++i)
      joined.nearest->values[i] = std::min(joined.nearest->values[i], nearest->values[i]);
}

void add_passes(const JoinedPasses& joined, Picture& picture) {
  const auto add = [&](const Channel& channel) {
    if (!find_channel(picture, channel.name)) picture.channels.push_back(channel);
  };
  std::ranges::for_each(joined.centres, add);
  for (const char* layer : {kObjects, kMaterials})
    if (const auto known = joined.layers.find(layer); known != joined.layers.end())
      add_cryptomatte(picture, layer, known->second);
  if (joined.nearest) add(*joined.nearest);
}

std::vector<std::string> pass_texts() {
  std::vector<std::string> names{kNodesText, kMaterialsText};
  for (const char* layer : {kObjects, kMaterials})
    for (const std::string& name : cryptomatte_texts(layer)) names.push_back(name);
  return names;
}

} // namespace wavepath
