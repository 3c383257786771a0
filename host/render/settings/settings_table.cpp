#include "host/render/settings/settings_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/render/settings/cover.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/direct_sampling.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/pass_names.h"
#include "host/render/settings/path_reuse.h"
#include "kernels/base/scene_types.h"

namespace wavepath {
namespace {

using S = RenderSettings;

constexpr std::uint32_t kLargestSide = 65536;
constexpr std::uint32_t kMostSamples = std::numeric_limits<std::int32_t>::max(); // the largest that EXR attributes hold
constexpr std::uint32_t kDeepest = 4096;
constexpr double kFarthest = 1e30;
constexpr std::array<std::string_view, 3> kDenoiseNames = {"off", "on", "oidn"};
constexpr double kFarthestFocus = 1e15; // metres: squares of what a camera ray is made of stay finite
constexpr std::uint32_t kMostBlades = 64;
constexpr double kMostRadiance = 1e30; // sums with direct light stay finite
static_assert(std::size(kLightSamplesNames) == gpu::kMostLightSamples + 1);
constexpr unsigned kByAll = kByRender | kByView | kByStudy | kByBench;
constexpr unsigned kByRenderAndView = kByRender | kByView;

// Values of --aov that every integrator takes; IntegratorKind::aovs lists those that only some take.
constexpr std::array<std::string_view, 12> kCommonAovs = {"albedo",   "normal",    "depth",    "position",
                                                          "variance", "samples",   "direct",   "indirect",
                                                          "emission", "roughness", "metallic", "ids"};

std::vector<std::string_view> rare_aovs() {
  std::vector<std::string_view> names;
  for (const IntegratorKind* kind : integrators())
    for (const std::string_view name : kind->aovs)
      if (std::ranges::count(names, name) == 0) names.push_back(name);
  return names;
}

std::string aov_meaning() {
  std::string text = fmt::format(
      "extra EXR channels, separated by commas: {}. Apart from the samples, by rays through the "
      "centres of pixels (cryptomatte and depth_min: by the rays of all samples): {}",
      fmt::join(kCommonAovs, ", "), fmt::join(kPassNames, ", "));
  for (const std::string_view name : rare_aovs())
    text += fmt::format(". {}: only with --integrator {}", name, aov_supporters_text(name));
  return text;
}

constexpr std::string_view kSummaryOfAuto =
    "short pilots of path, path --guide and bidirectional, of which the best renders";

std::string integrator_meaning() {
  std::string text;
  for (const IntegratorSetting& value : integrator_values())
    text += fmt::format("{}{}: {}", text.empty() ? "" : ". ", name_of(value),
                        value.is_auto() ? kSummaryOfAuto : value->summary);
  return text;
}

void read_aovs(const FlagValue& value, S& settings) {
  std::vector<std::string_view> names = rare_aovs();
  names.insert(names.begin(), kPassNames.begin(), kPassNames.end());
  names.insert(names.begin(), kCommonAovs.begin(), kCommonAovs.end());
  settings.aovs = value.list(names);
}

// Names of lights are those of the scene, which is not known yet.
void read_light_groups(const FlagValue& value, S& settings) {
  std::vector<std::string> names;
  for (std::size_t first = 0; first <= value.text.size();) {
    const std::size_t end = std::min(value.text.find(',', first), value.text.size());
    names.push_back(value.text.substr(first, end - first));
    first = end + 1;
  }
  if (names.size() > gpu::kMostLightGroups)
    value.refuse(fmt::format("names {} groups", names.size()), fmt::format("name at most {}", gpu::kMostLightGroups));
  for (const std::string& name : names) {
    if (name.empty()) value.refuse("has an empty name", "separate names of lights by single commas");
    if (std::ranges::count(names, name) > 1)
      value.refuse(fmt::format("names '{}' twice", name), "name every group once");
    if (name == "each" && names.size() > 1) value.refuse("has other names besides each", "give each alone, or names");
  }
  settings.light_groups = std::move(names);
}

void read_size(const FlagValue& value, S& settings) {
  const auto [width, height] = value.split('x', "write it as WIDTHxHEIGHT, such as 1280x720");
  settings.width = width.whole_number(1, kLargestSide);
  settings.height = height.whole_number(1, kLargestSide);
}

void read_crop(const FlagValue& value, S& settings) {
  const std::vector<double> numbers = value.numbers(4, "write it as X,Y,WIDTH,HEIGHT, such as 0,0,640,360");
  std::array<std::uint32_t, 4> pixels{};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!(numbers[i] >= 0.0 && numbers[i] <= kLargestSide) || numbers[i] != std::floor(numbers[i]))
      value.refuse("is not in whole pixels", fmt::format("give whole numbers from 0 to {}", kLargestSide));
    pixels[i] = static_cast<std::uint32_t>(numbers[i]);
  }
  settings.crop = Crop{pixels[0], pixels[1], pixels[2], pixels[3]};
  if (pixels[2] == 0 || pixels[3] == 0) value.refuse("is empty", "give a width and a height of 1 pixel or more");
}

std::string crop_text(const S& settings) {
  if (!settings.crop) return "";
  const Crop& crop = *settings.crop;
  return fmt::format("{},{},{},{}", crop.left, crop.top, crop.width, crop.height);
}

std::uint32_t whole_samples(const S& settings) {
  return settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
}

void read_samples(const FlagValue& value, S& settings) {
  const auto [first, last] = value.split(':', "write it as A:B, such as 0:64");
  settings.first_sample = first.whole_number(0, kMostSamples);
  settings.last_sample = last.whole_number(0, kMostSamples);
  if (settings.first_sample >= settings.last_sample) value.refuse("is an empty range", "give A:B with A below B");
}

std::string samples_text(const S& settings) {
  const bool whole = settings.first_sample == 0 && settings.last_sample == whole_samples(settings);
  return whole ? "" : fmt::format("{}:{}", settings.first_sample, settings.last_sample);
}

// Only the stratified sampler lays its points out for a known number of them.
std::string spp_identity(const S& settings) {
  return settings.sampler == gpu::kSamplerStratified ? fmt::format("{}", whole_samples(settings)) : "any";
}

// By kTechnique bit.
constexpr std::array<std::string_view, 5> kTechniqueNames = {"hit", "light", "connect", "splat", "merge"};

void read_techniques(const FlagValue& value, S& settings) {
  settings.techniques = 0;
  for (const std::string& name : value.list(kTechniqueNames))
    settings.techniques |= 1u << (std::ranges::find(kTechniqueNames, name) - kTechniqueNames.begin());
}

std::string techniques_text(const S& settings) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < kTechniqueNames.size(); ++i)
    if (settings.techniques >> i & 1u) names.push_back(kTechniqueNames[i]);
  return names.size() == kTechniqueNames.size() ? "" : fmt::format("{}", fmt::join(names, ","));
}

void read_focus(const FlagValue& value, S& settings) {
  settings.lens.focus.reset();
  if (value.text == "auto") return;
  if (!(value.positive_number() <= kFarthestFocus)) value.refuse("is too far", "give at most 1e15, or auto");
  settings.lens.focus = value.positive_number();
}

void read_blades(const FlagValue& value, S& settings) {
  settings.lens.blades = value.whole_number(0, kMostBlades);
  if (settings.lens.blades == 1 || settings.lens.blades == 2)
    value.refuse("is no polygon", fmt::format("give 3 to {}, or 0 for a disc", kMostBlades));
}

// A lens in front of the film.
std::vector<Setting> lens_rows() {
  std::vector<Setting> rows = {
      {.name = "aperture",
       .value = NumberValue{nullptr, 0.0, kFarthestFocus, &Lens::aperture},
       .meaning = "diameter of the aperture of a thin lens, in metres of the scene: focal length / f-number. 0: a "
                  "pinhole, everything is sharp",
       .placeholder = "METRES",
       .label = "aperture, metres"},
      {.name = "focus",
       .value =
           SpecialValue{read_focus,
                        [](const S& s) { return s.lens.focus ? fmt::format("{}", *s.lens.focus) : std::string(); }},
       .meaning = "distance to the sharp plane of --aperture, in metres along the view axis. auto: distance of the "
                  "surface in the middle of the picture",
       .placeholder = "METRES|auto",
       .initial = "auto"},
      {.name = "blades",
       .value = SpecialValue{read_blades, [](const S& s) { return fmt::format("{}", s.lens.blades); }},
       .meaning = "corners of the aperture: a regular polygon in the circle of diameter --aperture. 0: a disc",
       .placeholder = "N",
       .initial = "0"},
  };
  for (Setting& row : rows) {
    row.group = SettingGroup::lens;
    row.supported_by = SupportedBy::listed_else_refused;
    row.listed_as = "lens";
    row.offered = kByAll;
  }
  return rows;
}

std::vector<Setting> picture_rows() {
  return {
      {.name = "size",
       .value = SpecialValue{read_size, [](const S& s) { return fmt::format("{}x{}", s.width, s.height); }},
       .meaning = "width and height of the picture in pixels",
       .placeholder = "WxH",
       .group = SettingGroup::picture,
       .offered = kByAll,
       .always_copied = true},
      // Parts of one picture have one identity, so that they can be merged.
      {.name = "crop",
       .value = SpecialValue{read_crop, crop_text},
       .meaning = "render this rectangle of the picture only, X and Y from its left top corner, to the bits of the "
                  "whole picture; --size stays that of the whole",
       .placeholder = "X,Y,W,H",
       .initial = "all of it",
       .group = SettingGroup::picture,
       .advanced = true,
       .offered = kByRender,
       .identity = [](const S&) { return std::string(); }},
      {.name = "filter",
       .value = ChoiceValue{&S::filter, kFilterNames},
       .meaning = "pixel filter, importance-sampled",
       .initial = "blackman-harris; box if --reference is box-filtered",
       .group = SettingGroup::picture,
       .offered = kByRenderAndView | kByStudy},
      {.name = "light-groups",
       .value = SpecialValue{read_light_groups,
                             [](const S& s) { return fmt::format("{}", fmt::join(s.light_groups, ",")); }},
       .meaning = "groups of lights, each of which gets a layer of its own in EXR files, group.NAME.R,G,B: names of "
                  "nodes, lights or materials that shine, or environment, separated by commas. Other lights make a "
                  "group rest. each: a group for every lamp, every material that shines and the environment. The "
                  "layers add up to the picture, and 'wavepath relight' mixes them anew",
       .placeholder = "NAMES|each",
       .initial = "none",
       .group = SettingGroup::picture,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByRenderAndView,
       // Without groups no record says so, as in renders that know nothing of them.
       .identity = [](const S& s) { return fmt::format("{}", fmt::join(s.light_groups, ",")); }},
      // The film of a render with AOVs holds more sums, whichever AOVs are written.
      {.name = "aov",
       .value = SpecialValue{read_aovs, [](const S& s) { return fmt::format("{}", fmt::join(s.aovs, ",")); }},
       .meaning = aov_meaning(),
       .placeholder = "LIST",
       .initial = "none",
       .group = SettingGroup::picture,
       .decides = Decides::channels,
       .offered = kByRenderAndView,
       .identity =
           [](const S& s) {
             return std::string(records_aovs(s) ? "yes" : "no") +
                    (std::ranges::any_of(s.aovs, is_cover) ? ", cover" : "");
           }},
      {.name = "transparent",
       .value = SwitchValue{&S::transparent},
       .meaning = "the background is transparent: alpha tells how much of it is seen, past objects and through smooth "
                  "glass, and colour has no light that comes straight from it. EXR: premultiplied. PNG: straight",
       .group = SettingGroup::picture,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByRenderAndView,
       .label = "transparent"},
      {.name = "aov-through",
       .value = SwitchValue{&S::aov_through},
       .meaning =
           "channels albedo and normal show what is behind smooth glass and in mirrors, as Open Image Denoise wants "
           "them: the first surface on the path that scatters otherwise, its albedo tinted",
       .group = SettingGroup::picture,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByRenderAndView},
  };
}

std::vector<Setting> transport_rows() {
  std::vector<Setting> rows = {
      {.name = "integrator",
       .value = IntegratorValue{},
       .meaning = integrator_meaning(),
       .offered = kByRenderAndView,
       .always_copied = true, // a render without it takes what it measures to be best
       .label = "integrator",
       .planned = true},
      {.name = "sampler",
       .value = ChoiceValue{&S::sampler, kSamplerNames},
       .meaning = "kind of random numbers. sobol: Owen-scrambled Sobol points",
       .offered = kByRenderAndView | kByBench,
       .label = "sampler",
       .study = {"independent", "stratified", "sobol"}},
      {.name = "direct",
       .value = ChoiceValue{&S::direct, kDirectNames},
       .meaning = "estimator of direct light. nee: light sampling. bsdf: BSDF sampling. mis: both, by multiple "
                  "importance sampling",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .offered = kByRenderAndView | kByBench,
       .label = "direct light",
       .study = {"bsdf", "nee", "mis"}},
      {.name = "lights",
       .value = ChoiceValue{&S::lights, kLightSelectionNames},
       .meaning = "method to pick the light of a light sample. power: in proportion to power. tree: by a light tree, "
                  "from bounds on the contribution of each light. learned: by probabilities that a discarded pilot "
                  "learned for each part of the scene, also for regions of an environment map or of a sky. auto: "
                  "learned with an environment map or with many lights in many places, else power",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .offered = kByRenderAndView | kByBench,
       .label = "choice of lights"},
      {.name = "light-samples",
       .value = ChoiceValue{&S::light_samples, kLightSamplesNames},
       .meaning = fmt::format(
           "light samples at the first vertex where a path scatters; half as many at each later vertex. auto: {} with "
           "an environment map ({} if there are layered materials or a light tree too), else 1",
           kLightSamplesOfMaps, kFewLightSamplesOfMaps),
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .listed_as = "path sampling",
       .offered = kByRenderAndView | kByBench,
       .label = "light samples",
       .planned = true,
       .study = {"1", "2", "4", "8"}},
      {.name = "sky-samples",
       .value = ChoiceValue{&S::sky_samples, kLightSamplesNames},
       .meaning = "rays from each vertex to a sky of one colour, including the scattered ray. With --lights learned "
                  "the additional rays prefer visible regions of the sky, and later vertices have half as many. auto: "
                  "the best number by a discarded pilot; 1 in short renders. At most 9 minus the light samples",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .listed_as = "path sampling",
       .offered = kByRenderAndView | kByBench,
       .label = "sky samples",
       .planned = true,
       .unplanned = "1",
       .study = {"1", "2", "4", "8"}},
      {.name = "reuse",
       .value = ChoiceValue{&S::reuse, kReuseNames, "on"},
       .meaning = "path reuse: four neighbouring pixels use the indirect light of diffuse surfaces that each other's "
                  "paths found. Unbiased. auto: on if a discarded pilot measures a gain. --reuse alone means on",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .listed_as = "path sampling",
       .offered = kByRenderAndView | kByBench,
       .label = "reuse of paths",
       .planned = true,
       .unplanned = "off",
       .study = {"off", "on"},
       // What shares nothing has the bits, and the identity, of renders that know nothing of it.
       .identity = [](const S& s) { return std::string(reuses_paths(s) ? "on" : ""); }},
      {.name = "hemisphere",
       .value = ChoiceValue{&S::hemisphere, kHemisphereNames},
       .meaning = "distribution of diffuse directions",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .offered = kByRenderAndView | kByBench,
       .study = {"uniform", "cosine"}},
      {.name = "guide",
       .value = SwitchValue{&S::guide},
       .meaning = "path guiding: a discarded pilot learns the directions of light, and paths prefer these directions. "
                  "Unbiased. If the pilot predicts no gain, paths are not guided",
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByRender,
       .planned = true,
       .study = {"off", "on"}},
      {.name = "clamp",
       .value = NumberValue{&S::clamp, 0.0, kMostRadiance},
       .meaning = "dims samples whose brightest channel is above this radiance, and keeps their colour: no fireflies. "
                  "Biased; `bias` in the stats tells how much light it took. 0: no limit",
       .placeholder = "X",
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByRenderAndView,
       .label = "clamp samples at"},
      {.name = "max-depth",
       .value = WholeValue{&S::max_depth, 0, kDeepest},
       .meaning = "longest path in bounces. 0: only emission that the camera sees. 1: also direct light",
       .placeholder = "N",
       .offered = kByAll,
       .label = "bounces, most"},
      {.name = "seed",
       .value = WholeValue{&S::seed, 0, kMostSamples},
       .meaning = "seed of the random numbers. The same seed gives the same bits; another seed gives other noise",
       .placeholder = "N",
       .offered = kByAll,
       .label = "seed"},
      {.name = "cull",
       .value = ChoiceValue{&S::cull, kCullNames},
       .meaning = "rays that pass through the backs of single-sided surfaces. camera: only camera rays. all: all rays, "
                  "so light from behind casts no shadow. none: no ray",
       .offered = kByAll,
       .label = "pass backs"},
      {.name = "traversal",
       .value = ChoiceValue{&S::traversal, kTraversalNames},
       .meaning = "method to trace rays. compute: compute kernels. hardware: ray queries of the device. auto: hardware "
                  "if the device has ray tracing units. The two may hit different surfaces where surfaces coincide",
       .group = SettingGroup::speed,
       .advanced = true,
       .decides = Decides::nothing,
       .offered = kByAll},
      {.name = "textures",
       .value = ChoiceValue{&S::textures, kTextureFilterNames},
       .meaning = "texture filtering. exact: by kernels, in single precision, with the same bits on every device. "
                  "hardware: by the device's samplers for 8-bit textures; their weights have 8 bits, which is biased",
       .offered = kByAll,
       .study = {"exact", "hardware"}},
      {.name = "terminator",
       .value = ChoiceValue{&S::terminator, kTerminatorNames},
       .meaning = "start of rays on coarse meshes with smooth normals. facets: on the triangles, which may show hard "
                  "shadow steps at grazing light. smooth: on the smooth surface, which is biased",
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByAll},
      {.name = "specialize",
       .value = OnOffValue{&S::specialize},
       .meaning = "kernels compiled for the features of the scene. off: generic kernels, same picture, slower",
       .group = SettingGroup::speed,
       .advanced = true,
       .decides = Decides::nothing,
       .offered = kByRenderAndView | kByBench},
  };
  for (Setting& row : rows)
    if (row.name == "integrator")
      for (const IntegratorKind* kind : integrators()) row.study.push_back(kind->name);
  return rows;
}

std::vector<Setting> stop_rows() {
  return {
      {.name = "spp",
       .value = WholeValue{&S::sample_total, 1, kMostSamples, &S::last_sample},
       .meaning = "samples per pixel",
       .placeholder = "N",
       .initial = "64; 65536 if only --time or --target-error is given",
       .group = SettingGroup::stop,
       .offered = kByRenderAndView,
       .always_copied = true,
       .label = "samples, spp",
       .identity = spp_identity},
      {.name = "time",
       .value = PositiveValue{&S::time_limit},
       .meaning = "longest rendering time in seconds, without loading and compiling",
       .placeholder = "SECONDS",
       .initial = "no limit",
       .group = SettingGroup::stop,
       .decides = Decides::nothing,
       .offered = kByRender},
      {.name = "target-error",
       .value = PositiveValue{&S::target_error},
       .meaning = "estimated relative RMS error to reach; 0.01 is 1 %. Exit code 3 if another limit came first",
       .placeholder = "E",
       .initial = "none",
       .group = SettingGroup::stop,
       .decides = Decides::nothing,
       .offered = kByRenderAndView},
      // Renders of several ranges are parts of one picture, so that they share its identity.
      {.name = "samples",
       .value = SpecialValue{read_samples, samples_text},
       .meaning = "range of sample indices A <= s < B: a part of a render, for 'wavepath merge'. Every part needs the "
                  "--spp of the whole",
       .placeholder = "A:B",
       .initial = "0:spp",
       .group = SettingGroup::parts,
       .offered = kByRender,
       .identity = [](const S&) { return std::string(); }},
      {.name = "adaptive",
       .value = ChoiceValue{&S::adaptive, kAdaptiveNames, "on"},
       .meaning = "adaptive sampling: more samples where a discarded pilot finds more noise. --spp is then the "
                  "average. Unbiased. auto: on if the pilot predicts a gain, from 4 samples on, but never in parts of "
                  "a render. --adaptive alone means on",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByRender,
       .planned = true,
       .unplanned = "off"},
  };
}

std::vector<Setting> special_rows() {
  std::vector<Setting> rows = {
      {.name = "first-hit",
       .value = ChoiceValue{&S::first_hit, kFirstHitNames},
       .meaning = "method to find the visible surfaces. raster: rasterization. traced: camera rays. auto: raster; "
                  "traced on CPUs if the scene has more triangles than the picture has pixels, and on NVIDIA's Hopper "
                  "GPUs, which rasterize slowly",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .label = "first hits",
       .study = {"raster", "traced"}},
      {.name = "shadow-samples",
       .value = WholeValue{&S::shadow_samples, 1, kMostFrameRays},
       .meaning = "light samples for each sample of a pixel, stratified",
       .placeholder = "N",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .label = "shadow rays",
       .study = {"1", "4", "16"}},
      {.name = "ao-samples",
       .value = WholeValue{&S::ao_samples, 1, kMostFrameRays},
       .meaning = "occlusion rays for each sample of a pixel, cosine-weighted and stratified. With --occlusion ssao "
                  "they are points, with hbao directions, with gtao slices, with cones cones",
       .placeholder = "N",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .label = "occlusion rays",
       .study = {"1", "4", "16"}},
      {.name = "ao-radius",
       .value = OptionalNumberValue{&S::ao_radius, 0.0, kFarthest},
       .meaning = "largest distance of an occluder, in metres. 0: no limit",
       .placeholder = "METRES",
       .initial = "a tenth of the scene's radius; 0 for --integrator ao with rays",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused},
      {.name = "ambient",
       .value = RadianceValue{&S::ambient, kMostRadiance},
       .meaning = "constant radiance in place of all light of more than one bounce. --max-depth 1 leaves it out",
       .placeholder = "R,G,B",
       .initial = "hybrid: estimated from the direct light in the picture; whitted: black",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused},
      {.name = "branching",
       .value = ChoiceValue{&S::branching, kBranchingNames},
       .meaning =
           "rays that mirrors and glass send on. tree: reflection and refraction. choice: one of them, at random",
       .group = SettingGroup::others,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .label = "branching",
       .study = {"tree", "choice"}},
      {.name = "techniques",
       .value = SpecialValue{read_techniques, techniques_text},
       .meaning =
           fmt::format("techniques to find light, separated by commas: {}. Light that none of them finds is missing",
                       fmt::join(kTechniqueNames, ", ")),
       .placeholder = "LIST",
       .initial = "all",
       .group = SettingGroup::others,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .planned = true},
      {.name = "cutoff",
       .value = NumberValue{&S::cutoff, 0.0, 1.0},
       .meaning = "weight of a ray at or below which it is not followed. 0: all rays are followed",
       .placeholder = "W",
       .initial = "0.00390625 (1/256)",
       .group = SettingGroup::others,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused},
      {.name = "mips",
       .value = OnOffValue{&S::mips},
       .meaning = "mip levels of textures, in pictures of one sample per pixel and in a window while the camera moves. "
                  "They reduce the noise of distant textures, and are biased",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .identity = [](const S& s) { return std::string(uses_mips(s) ? "on, for one sample"
                                                       : s.mips     ? "on"
                                                                    : "off"); }},
      {.name = "denoise",
       .value = ChoiceValue{&S::denoise, kDenoiseNames, "on"},
       .meaning = "noise filter, which is biased. It filters the finished picture; an EXR then has denoised.R,G,B as "
                  "well as R,G,B. hybrid and ao instead filter every frame, over space and time. oidn: Intel's Open "
                  "Image Denoise, if it is installed",
       .placeholder = "[oidn]",
       .group = SettingGroup::picture,
       .supported_by = SupportedBy::listed_else_refused,
       .label = "denoise",
       .study = {"off", "on"},
       // Filters of finished pictures change no sum of the film.
       .identity = [](const S& s) { return std::string(s.integrator->traces_paths ? "" : kDenoiseNames[s.denoise]); }},
  };
  for (Setting& row : rows) row.offered = kByRenderAndView;
  return rows;
}

// The order is that of --help within each group, of copied commands and of the panel.
std::vector<Setting> all_rows() {
  std::vector<Setting> rows;
  for (std::vector<Setting> part : {picture_rows(), lens_rows(), transport_rows(), stop_rows(), special_rows()})
    for (Setting& row : part) rows.push_back(std::move(row));
  for (const IntegratorKind* kind : integrators())
    if (kind->rows)
      for (Setting& row : kind->rows()) rows.push_back(std::move(row));
  return rows;
}

} // namespace

std::span<const Setting> settings_table() {
  static const std::vector<Setting> kRows = all_rows();
  return kRows;
}

const Setting& setting_named(std::string_view name) {
  return *std::ranges::find(settings_table(), name, &Setting::name);
}

bool supports(const IntegratorKind& kind, std::string_view setting) {
  const auto row = std::ranges::find(settings_table(), setting, &Setting::name);
  const bool with_others = row != settings_table().end() && !row->listed_as.empty();
  return std::ranges::count(kind.settings, with_others ? row->listed_as : setting) > 0;
}

bool supports(const IntegratorSetting& integrator, std::string_view setting) {
  if (!integrator.is_auto()) return supports(*integrator, setting);
  return std::ranges::any_of(integrators(), [&](const IntegratorKind* kind) {
    return kind->candidates && supports(*kind, setting) && std::ranges::count(kind->not_by_auto, setting) == 0;
  });
}

std::string flags_of(const RenderSettings& settings) {
  std::string flags;
  for (const Setting& row : settings_table()) {
    const bool copied = row.always_copied || (row.decides == Decides::picture && !is_default(row, settings));
    if (!copied || !is_supported(row, settings)) continue;
    if (const std::string flag = flag_text(row, settings); !flag.empty()) flags += " " + flag;
  }
  return flags;
}

} // namespace wavepath
