// Builds the stats document.
#include "host/render/report/stats.h"
#include "host/render/report/camera_json.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/film/error.h"
#include "host/film/film.h"
#include "host/film/group_layers.h"
#include "host/plan/bvh_quality.h"
#include "host/plan/record.h"
#include "host/render/report/diagnosis.h"
#include "host/render/report/lamp_extents.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/kernel_compiler.h"
#include "kernels/base/learned_sky_types.h"
#include "kernels/base/tile_order.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const RayCounts& rays) {
  return {{"camera", rays.camera}, {"bounce", rays.bounce}, {"shadow", rays.shadow}, {"occlusion", rays.occlusion}};
}

Json to_json(const Checkpoint& checkpoint, const TrueError* error) {
  Json json{{"spp", checkpoint.spp},
            {"seconds", checkpoint.seconds},
            {"gpu_seconds", checkpoint.gpu_seconds},
            {"rays", checkpoint.rays.total()},
            {"estimated_relative_rms", nullptr},
            {"estimated_ci95", nullptr},
            {"mse", nullptr},
            {"relmse", nullptr},
            {"mrse", nullptr},
            {"flip", nullptr}};
  if (has_estimate(checkpoint.spp, checkpoint.error)) json["estimated_relative_rms"] = checkpoint.error.relative_rms;
  if (!json["estimated_relative_rms"].is_null()) json["estimated_ci95"] = checkpoint.error.ci95;
  if (error && error->metrics.finite()) {
    json["mse"] = error->metrics.mse;
    json["relmse"] = error->metrics.relmse;
    json["mrse"] = error->metrics.mrse;
    json["flip"] = error->flip;
  }
  return json;
}

Json seconds_json(const Run& run) {
  Json first_pixel = nullptr; // stopped before every pixel had a sample
  if (run.result.spp > 0) first_pixel = run.result.first_pixel_seconds;
  Json seconds = {{"load", run.load_seconds},
                  {"bvh", run.packed.bvh_seconds},
                  {"upload", run.result.upload_seconds},
                  {"compile", run.result.compile_seconds},
                  {"render", run.result.seconds},
                  {"write", run.write_seconds},
                  {"first_pixel", first_pixel},
                  {"total", run.total_seconds}};
  if (run.pass_seconds) seconds["passes"] = *run.pass_seconds;
  return seconds;
}

// Seconds and samples that halving the error would take in addition, if it goes on falling at its present rate.
Json next_halving_json(const RenderResult& result) {
  const double growth = growth_for(2.0, result.slope),
               more = growth_for(2.0, fit_slope(result.checkpoints, Against::spp));
  if (!std::isfinite(growth) || !std::isfinite(more)) return nullptr;
  return {{"seconds", result.seconds * (growth - 1.0)}, {"spp", std::ceil(result.spp * (more - 1.0))}};
}

const char* error_method(const Film* film) {
  if (!film || !film->has_probes)
    return "spread of the means of 2 independently scrambled halves of the samples of every pixel";
  if (film->quads)
    return "error probes: spread of the means of 2 independently scrambled replicates of one quad of each block";
  return "error probes: spread of the means of 2 independently scrambled replicates of one pixel of each block";
}

Json error_json(const Run& run) {
  const RenderResult& result = run.result;
  Json json{{"relative_rms", nullptr},
            {"ci95", nullptr},
            {"method", error_method(result.film.get())},
            {"slope", result.slope},
            {"slope_spp", fit_slope(result.checkpoints, Against::spp)},
            {"next_halving", nullptr},
            {"largest_sample_share", nullptr},
            {"trusted", is_trusted(result)},
            {"diagnosis", run.diagnosis},
            {"estimate_seconds", result.estimate_seconds}};
  if (has_estimate(result.spp, result.error)) {
    json["relative_rms"] = result.error.relative_rms;
    json["ci95"] = {result.error.ci95[0], result.error.ci95[1]};
    json["next_halving"] = next_halving_json(result);
    json["largest_sample_share"] = result.error.largest_sample_fraction;
  }
  return json;
}

Json json(const Setting& row, const RenderPlan& settings) {
  const std::string text = text_of(row, settings);
  if (text.empty() || !is_supported(row, settings)) return nullptr;
  if (std::holds_alternative<OnOffValue>(row.value) || std::holds_alternative<SwitchValue>(row.value))
    return text == "on";
  if (std::holds_alternative<RadianceValue>(row.value)) return Json::parse("[" + text + "]");
  const bool is_number =
      std::holds_alternative<WholeValue>(row.value) || std::holds_alternative<NumberValue>(row.value) ||
      std::holds_alternative<PositiveValue>(row.value) || std::holds_alternative<OptionalNumberValue>(row.value);
  return is_number ? Json::parse(text) : Json(text);
}

Json radiosity_json(const std::optional<RadiosityReport>& radiosity) {
  if (!radiosity) return nullptr;
  return {{"patches", radiosity->patches}, {"shots", radiosity->shots},         {"links", radiosity->links},
          {"rays", radiosity->rays},       {"absorbed", radiosity->absorbed}, // of the light of all lamps
          {"lost", radiosity->lost},       {"remaining", radiosity->remaining}, {"seconds", radiosity->seconds},
          {"kept", radiosity->kept},       {"bytes", radiosity->bytes}};
}

Json merge_json(const std::optional<MergeReport>& merging) {
  if (!merging) return nullptr;
  return {{"first_radius", merging->first_radius}, // metres
          {"last_radius", merging->last_radius},
          {"photon_paths", merging->photon_paths},
          {"block", merging->block},
          {"bytes", merging->bytes}};
}

Json guide_json(const std::optional<GuideReport>& guide) {
  if (!guide) return nullptr;
  return {{"used", guide->used},     {"variance", guide->variance}, {"probability", guide->probability},
          {"leaves", guide->leaves}, {"bytes", guide->bytes},       {"pilot_paths", guide->training_paths}};
}

Json denoise_json(const Run& run) {
  const std::optional<DenoiseReport>& report = run.result.denoised;
  if (!report) return nullptr;
  Json json = {{"filter", report->filter}, {"seconds", report->seconds}, {"light_ratio", report->light}};
  if (run.denoised_error && run.denoised_error->metrics.finite())
    json.update({{"mse", run.denoised_error->metrics.mse},
                 {"relmse", run.denoised_error->metrics.relmse},
                 {"mrse", run.denoised_error->metrics.mrse},
                 {"flip", run.denoised_error->flip}});
  return json;
}

// Every row of the table by its name with '_' for '-'; null where it is not set, or not taken by the integrator.
Json settings_json(const RenderPlan& settings) {
  Json object = Json::object();
  for (const Setting& row : settings_table()) {
    std::string key(row.name);
    std::ranges::replace(key, '-', '_');
    object[key] = json(row, settings);
  }
  return object;
}

// A picture that is no frame has no such key.
Json frame_json(const FrameReport& frame) {
  Json kept = Json::array();
  if (frame.kept_surfaces) kept.push_back("surfaces");
  if (frame.kept_geometry) kept.push_back("geometry");
  return {{"number", frame.number},
          {"at", frame.at},
          {"fps", frame.fps},
          {"turned", frame.turned},
          {"seconds", {{"pose", frame.pose_seconds}, {"pack", frame.pack_seconds}}},
          {"kept", kept},
          {"built_triangles", frame.built_triangles}};
}

// Each group of lights, its layer, and its share of the picture's light.
Json groups_json(const RenderPlan& settings, const Film& film) {
  const std::vector<std::string> layers = group_layers(settings.group_names);
  std::vector<double> sums(film.group_count);
  double all = 0.0;
  for (std::uint32_t g = 0; g < film.group_count; ++g)
    for (std::size_t pixel = 0; pixel < film.shape().pixels(); ++pixel) {
      const double light = glm::dot(mean_group(film, pixel, g), glm::dvec3(0.2126, 0.7152, 0.0722));
      sums[g] += light, all += light;
    }
  Json groups = Json::array();
  for (std::uint32_t g = 0; g < film.group_count; ++g)
    groups.push_back(
        {{"name", settings.group_names[g]}, {"layer", layers[g]}, {"share", all > 0.0 ? Json(sums[g] / all) : Json()}});
  return groups;
}

Json nonfinite_json(const Nonfinite& nonfinite, const RenderPlan& settings) {
  Json first = nullptr, by_kernel = Json::object();
  if (nonfinite.first) {
    const glm::uvec2 at = gpu::pixel_in_tile_order(nonfinite.first->at.pixel, settings.width, settings.height);
    first = {{"pixel", {at.x, at.y}},
             {"sample", nonfinite.first->sample},
             {"net", nonfinite.first->at.replicate},
             {"seed", settings.seed},
             {"kernel", kMakerNames[nonfinite.first->maker]}};
  }
  for (std::size_t maker = 0; maker < kMakerNames.size(); ++maker)
    by_kernel[std::string(kMakerNames[maker])] = nonfinite.by_maker[maker];
  return {{"samples", nonfinite.samples()}, {"first", first}, {"by_kernel", by_kernel}};
}

} // namespace

Json textures_json(const RenderPlan& settings, const PackedScene& packed) {
  std::size_t sampled = 0;
  for (const gpu::Texture& texture : packed.textures) sampled += (texture.flags & gpu::kTextureSampled) != 0;
  return {{"filtering", kTextureFilterNames[settings.textures]},
          {"by_sampler", sampled},
          {"exact", packed.textures.size() - sampled},
          {"texel_bytes", packed.texels.size() * sizeof(std::uint32_t)},
          {"image_bytes", packed.atlases[0].bytes() + packed.atlases[1].bytes()}};
}

Json bvh_json(const PackedScene& packed) {
  const std::uint64_t bytes =
      packed.nodes.size() * sizeof(bvh::WideNode) + packed.triangles.size() * sizeof(gpu::Triangle);
  return {{"quality", kQualityNames[static_cast<std::size_t>(packed.bvh_quality)]},
          {"build_seconds", packed.bvh_seconds},
          {"sah", packed.sah_cost},
          {"nodes", packed.nodes.size()},
          {"copies", packed.triangles.size() - packed.triangles_stored},
          {"bytes", bytes},
          {"bytes_per_triangle",
           static_cast<double>(bytes) / static_cast<double>(std::max<std::uint64_t>(packed.triangles_stored, 1))}};
}

// Trained probabilities of the parts of an environment map; null where there are none.
Json sky_selection_json(const LightTraining& pilot) {
  if (pilot.sky_cells == 0) return nullptr;
  return {{"parts", gpu::kSkyParts},
          {"cells", pilot.sky_cells},
          {"pilot_paths", pilot.paths},
          {"pilot_seconds", pilot.seconds}};
}

// Selection of lights by next-event estimation; null if it samples none.
Json light_selection_json(const Run& run) {
  const PackedScene& packed = run.packed;
  if (packed.lights.empty()) return nullptr;
  const RenderPlan& settings = run.settings;
  const bool tree = !packed.light_tree.empty() && walks_light_tree(settings);
  const Json sky = sky_selection_json(run.result.light_training);
  if (!tree) return {{"by", "power"}, {"places", packed.light_locations}, {"sky", sky}};
  Json selection = {{"by", run.result.light_training.cells > 0 ? "learned" : "tree"},
                    {"places", packed.light_locations},
                    {"nodes", packed.local_light_count - 1},
                    {"depth", packed.light_tree_depth},
                    {"bytes", packed.light_tree.size() * sizeof(packed.light_tree[0])}};
  if (run.result.light_training.cells > 0)
    selection.update({{"cells", run.result.light_training.cells},
                      {"pilot_paths", run.result.light_training.paths},
                      {"pilot_seconds", run.result.light_training.seconds}});
  selection["sky"] = sky;
  return selection;
}

// Work of each of several devices.
Json devices_json(const MultiDeviceResult& shared) {
  Json devices = Json::array();
  for (const DeviceWork& work : shared.device_work) {
    Json ranges = Json::array();
    for (const SampleRange& range : work.ranges) ranges.push_back({range.first, range.end});
    const double rate = work.seconds > 0.0 ? 1e-6 * static_cast<double>(work.rays) / work.seconds : 0.0;
    devices.push_back({{"name", work.name},
                       {"driver", work.driver},
                       {"samples", work.samples()},
                       {"ranges", ranges},
                       {"seconds", work.seconds},
                       {"mrays_per_second", rate},
                       {"lost", work.lost}});
  }
  return {{"bits_agree", shared.bits_agree}, {"shares", devices}};
}

Json stats_document(const Run& run) {
  const RenderResult& result = run.result;
  const RenderPlan& settings = run.settings;
  Json left_out = Json::array(), checkpoints = Json::array(), stages = Json::array();
  for (const LeftOut& entry : run.packed.left_out)
    left_out.push_back({{"what", entry.what}, {"why", entry.why}, {"bytes", entry.bytes}});
  if (result.by_query)
    left_out.push_back({{"what", "nodes of the BVH"},
                        {"why", "the device traces rays through structures of its own"},
                        {"bytes", run.packed.nodes.size() * sizeof(bvh::WideNode)}});
  for (const OmittedStage& entry : settings.integrator->omitted(settings))
    left_out.push_back({{"what", entry.what}, {"why", entry.why}, {"bytes", 0}});
  for (std::size_t i = 0; i < result.checkpoints.size(); ++i)
    checkpoints.push_back(to_json(result.checkpoints[i], i < run.true_errors.size() ? &run.true_errors[i] : nullptr));
  for (const StageTime& stage : result.stages)
    stages.push_back({{"name", stage.name}, {"seconds", stage.seconds}, {"dispatches", stage.dispatches}});

  Json document = {
      {"wavepath", WAVEPATH_VERSION},
      {"scene", run.scene},
      {"command", run.command},
      {"repeat", run.repeat.empty() ? Json() : Json(run.repeat)},
      {"seed", settings.seed},
      {"sampler", kSamplerNames[settings.sampler]},
      {"integrator", settings.integrator->name},
      {"plan", to_json(run.plan)},
      {"max_depth", settings.max_depth},
      {"settings", settings_json(settings)},
      {"hybrid", settings.integrator->stats(settings, run.packed, result)},
      {"guide", guide_json(result.guide)},
      {"merge", merge_json(result.merging)},
      {"radiosity", radiosity_json(result.radiosity)},
      {"denoise", denoise_json(run)},
      {"device",
       {{"name", run.device.name}, {"driver", run.device.driver}, {"type", run.device.type}, {"api", run.device.api}}},
      {"devices", run.shared ? devices_json(*run.shared) : Json()},
      {"camera", run.view ? camera_json(*run.view, run.settings.width, run.settings.height) : Json()},
      {"size", {settings.width, settings.height}},
      {"spp", result.spp},
      {"triangles", run.packed.triangle_count},
      {"cut",
       {{"triangles", run.packed.cut.triangles}, {"pieces", run.packed.cut.pieces}, {"coarse", run.packed.cut.coarse}}},
      {"lights", run.packed.lights.size()},
      {"soft_lamps", lamp_extents_json(run.packed)},
      {"light_selection", light_selection_json(run)},
      {"seconds", seconds_json(run)},
      {"bvh", bvh_json(run.packed)},
      {"textures", textures_json(settings, run.packed)},
      {"traversal", result.by_query ? "hardware" : "compute"},
      {"rays", to_json(result.rays)},
      {"mrays_per_second",
       result.seconds > 0.0 ? 1e-6 * static_cast<double>(result.rays.total()) / result.seconds : 0.0},
      {"error", error_json(run)},
      {"nonfinite", nonfinite_json(result.nonfinite, settings)},
      {"bias", run.bias},
      {"left_out", left_out},
      {"memory",
       {{"scene", result.memory.scene},
        {"bvh", result.memory.bvh},
        {"paths", result.memory.paths},
        {"film", result.memory.film},
        {"peak", run.peak_bytes}}},
      {"checkpoints", checkpoints},
      {"gpu_seconds", result.gpu_seconds},
      {"stages", stages}};
  if (run.frame) document["frame"] = frame_json(*run.frame);
  if (!settings.group_names.empty() && result.film) document["light_groups"] = groups_json(settings, *result.film);
  return document;
}

std::string to_text(const Json& document) {
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void set_last_seconds(const Run& run, Json& document) {
  document["seconds"]["write"] = run.write_seconds;
  document["seconds"]["total"] = run.total_seconds;
}

std::optional<double> estimated_error(const RenderResult& result) {
  return has_estimate(result.spp, result.error) ? std::optional(result.error.relative_rms) : std::nullopt;
}

} // namespace wavepath
