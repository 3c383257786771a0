#include "host/render/settings/settings_table.h"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/light_samples.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/path_reuse.h"

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
  std::string text = fmt::format("extra EXR channels, separated by commas: {}", fmt::join(kCommonAovs, ", "));
  for (const std::string_view name : rare_aovs())
    text += fmt::format(". {}: only with --integrator {}", name, aov_supporters_text(name));
  return text;
}

std::string integrator_meaning() {
  std::string text;
  for (const IntegratorKind* kind : integrators())
    text += fmt::format("{}{}: {}", text.empty() ? "" : ". ", kind->name, kind->summary);
  return text;
}

void read_aovs(const FlagValue& value, S& settings) {
  std::vector<std::string_view> names = rare_aovs();
  names.insert(names.begin(), kCommonAovs.begin(), kCommonAovs.end());
  settings.aovs = value.list(names);
}

void read_size(const FlagValue& value, S& settings) {
  const auto [width, height] = value.split('x', "write it as WIDTHxHEIGHT, such as 1280x720");
  settings.width = width.whole_number(1, kLargestSide);
  settings.height = height.whole_number(1, kLargestSide);
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
       .meaning = "diameter of the aperture of a thin lens, in metres of the scene: focal length / f-number. What is "
                  "out of focus is blurred. 0 is a pinhole, which keeps everything sharp",
       .placeholder = "METRES",
       .label = "aperture, metres"},
      {.name = "focus",
       .value =
           SpecialValue{read_focus,
                        [](const S& s) { return s.lens.focus ? fmt::format("{}", *s.lens.focus) : std::string(); }},
       .meaning = "distance along the view axis that --aperture keeps sharp, in metres. auto: what the middle of the "
                  "picture shows",
       .placeholder = "METRES|auto",
       .initial = "auto"},
      {.name = "blades",
       .value = SpecialValue{read_blades, [](const S& s) { return fmt::format("{}", s.lens.blades); }},
       .meaning =
           "corners of the aperture, a regular polygon within the circle of diameter --aperture. 0 is the whole disc",
       .placeholder = "N",
       .initial = "0"},
  };
  for (Setting& row : rows) {
    row.group = SettingGroup::lens;
    row.supported_by = SupportedBy::listed_else_refused;
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
      {.name = "filter",
       .value = ChoiceValue{&S::filter, kFilterNames},
       .meaning = "pixel filter, importance-sampled",
       .initial = "blackman-harris; box if --reference is box-filtered",
       .group = SettingGroup::picture,
       .offered = kByRenderAndView | kByStudy},
      // The film of a render with AOVs holds more sums, whichever AOVs are written.
      {.name = "aov",
       .value = SpecialValue{read_aovs, [](const S& s) { return fmt::format("{}", fmt::join(s.aovs, ",")); }},
       .meaning = aov_meaning(),
       .placeholder = "LIST",
       .initial = "none",
       .group = SettingGroup::picture,
       .decides = Decides::channels,
       .offered = kByRenderAndView,
       .identity = [](const S& s) { return std::string(records_aovs(s) ? "yes" : "no"); }},
  };
}

std::vector<Setting> transport_rows() {
  std::vector<Setting> rows = {
      {.name = "integrator",
       .value = IntegratorValue{},
       .meaning = integrator_meaning(),
       .offered = kByRenderAndView,
       .always_copied = true, // a render without it takes what it measures to be best
       .label = "integrator"},
      {.name = "sampler",
       .value = ChoiceValue{&S::sampler, kSamplerNames},
       .meaning = "random numbers of the samples. sobol: Owen-scrambled Sobol points",
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
       .meaning = "choice of the light that a light sample goes to. power: in proportion to power. tree: by a light "
                  "tree, which bounds what each light contributes. learned: by what a pilot measured near each point, "
                  "for parts of an environment map or of a sky as well; the pilot's samples are discarded. auto: "
                  "learned under an environment map or with many lights in many places, else power",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .offered = kByRenderAndView | kByBench,
       .label = "choice of lights"},
      {.name = "light-samples",
       .value = ChoiceValue{&S::light_samples, kLightSamplesNames},
       .meaning = fmt::format(
           "light samples where a path first scatters; half as many at each later bounce. auto: {} under an "
           "environment map, or {} there if materials have layers or lights a tree; else 1",
           kLightSamplesOfMaps, kFewLightSamplesOfMaps),
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .offered = kByRenderAndView | kByBench,
       .label = "light samples",
       .study = {"1", "2", "4", "8"}},
      {.name = "sky-samples",
       .value = ChoiceValue{&S::sky_samples, kLightSamplesNames},
       .meaning = "directions in which each vertex looks for a sky of one colour, the path's own among them. With "
                  "--lights learned the others go where the sky was seen, and their number halves at each bounce. "
                  "auto: the number that a discarded pilot measured to be best, in renders that are long enough, else "
                  "1. At most 9 less the light samples",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .offered = kByRenderAndView | kByBench,
       .label = "sky samples",
       .study = {"1", "2", "4", "8"}},
      {.name = "reuse",
       .value = ChoiceValue{&S::reuse, kReuseNames, "on"},
       .meaning = "path reuse: four neighbouring pixels share the light that their paths find after the first diffuse "
                  "surface. Weights keep the picture the same on average. auto: on where a discarded pilot measures a "
                  "gain. --reuse alone means on",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByRenderAndView | kByBench,
       .label = "reuse of paths",
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
       .meaning = "path guiding: a pilot learns where light comes from, and paths go there more often. Where it "
                  "promises no gain, paths stay unguided. Unbiased: the pilot's samples are discarded",
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByRender,
       .study = {"off", "on"}},
      {.name = "max-depth",
       .value = WholeValue{&S::max_depth, 0, kDeepest},
       .meaning = "longest path in bounces. 0: emission seen directly. 1: direct light as well",
       .placeholder = "N",
       .offered = kByAll,
       .label = "bounces, most"},
      {.name = "seed",
       .value = WholeValue{&S::seed, 0, kMostSamples},
       .meaning = "seed of the random numbers. The same seed gives the same bits, another seed other noise",
       .placeholder = "N",
       .offered = kByAll,
       .label = "seed"},
      {.name = "cull",
       .value = ChoiceValue{&S::cull, kCullNames},
       .meaning = "rays that pass through single-sided surfaces from behind. camera: those of the camera. all: all "
                  "rays, so that such surfaces cast no shadow backwards. none: no rays",
       .offered = kByAll,
       .label = "pass backs"},
      {.name = "traversal",
       .value = ChoiceValue{&S::traversal, kTraversalNames},
       .meaning = "way to trace rays. compute: compute kernels. hardware: the device's ray queries. auto: hardware "
                  "where the device has units for it. Of surfaces at the same place the two may hit different ones",
       .group = SettingGroup::speed,
       .advanced = true,
       .decides = Decides::nothing,
       .offered = kByAll},
      {.name = "textures",
       .value = ChoiceValue{&S::textures, kTextureFilterNames},
       .meaning = "texture filtering. exact: single precision, with the same bits on every device. hardware: textures "
                  "of 8 bits by the device's samplers, whose weights have 8 bits too, which is biased",
       .offered = kByAll,
       .study = {"exact", "hardware"}},
      {.name = "terminator",
       .value = ChoiceValue{&S::terminator, kTerminatorNames},
       .meaning = "start of rays that leave a coarse mesh with smooth normals. facets: the triangles of the file, "
                  "which may show hard lines where light grazes. smooth: the smooth surface that they stand for",
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByAll},
      {.name = "specialize",
       .value = OnOffValue{&S::specialize},
       .meaning = "compile kernels without what the scene does not need. off gives the same image, slower",
       .group = SettingGroup::speed,
       .advanced = true,
       .decides = Decides::nothing,
       .offered = kByRenderAndView | kByBench},
  };
  for (Setting& row : rows)
    if (row.name == "integrator")
      for (const IntegratorKind* kind : integrators())
        if (!kind->candidates) row.study.push_back(kind->name);
  return rows;
}

std::vector<Setting> stop_rows() {
  return {
      {.name = "spp",
       .value = WholeValue{&S::sample_total, 1, kMostSamples, &S::last_sample},
       .meaning = "samples per pixel",
       .placeholder = "N",
       .initial = "64; 65536 where only --time or --target-error is given",
       .group = SettingGroup::stop,
       .offered = kByRenderAndView,
       .always_copied = true,
       .label = "samples, spp",
       .identity = spp_identity},
      {.name = "time",
       .value = PositiveValue{&S::time_limit},
       .meaning = "rendering time in seconds, without loading and compiling",
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
       .meaning = "range of sample indices A <= s < B to render, for splitting and merging. Every part needs the --spp "
                  "of the whole",
       .placeholder = "A:B",
       .initial = "0:spp",
       .group = SettingGroup::parts,
       .offered = kByRender,
       .identity = [](const S&) { return std::string(); }},
      {.name = "adaptive",
       .value = ChoiceValue{&S::adaptive, kAdaptiveNames, "on"},
       .meaning = "more samples where a pilot finds more noise; --spp is then the average. Unbiased: the pilot's "
                  "samples are discarded. auto: on where it pays, in renders of 4 samples or more, but never in parts "
                  "of a render. --adaptive alone means on",
       .group = SettingGroup::decisions,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .offered = kByRender},
  };
}

std::vector<Setting> special_rows() {
  std::vector<Setting> rows = {
      {.name = "first-hit",
       .value = ChoiceValue{&S::first_hit, kFirstHitNames},
       .meaning = "way to find what pixels see. raster: rasterization. traced: camera rays. auto: raster, but traced "
                  "on CPUs where the scene has more triangles than the picture has pixels, and on NVIDIA's Hopper "
                  "cards, which rasterize slowly",
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
       .meaning = "occlusion rays for each sample of a pixel, cosine-weighted and stratified. With --occlusion ssao: "
                  "points; hbao: directions; gtao: slices",
       .placeholder = "N",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_ignored,
       .label = "occlusion rays",
       .study = {"1", "4", "16"}},
      {.name = "ao-radius",
       .value = OptionalNumberValue{&S::ao_radius, 0.0, kFarthest},
       .meaning = "distance in metres beyond which nothing occludes. 0: no limit",
       .placeholder = "METRES",
       .initial = "a tenth of the scene's radius; 0 for --integrator ao with rays",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused},
      {.name = "ambient",
       .value = RadianceValue{&S::ambient, kMostRadiance},
       .meaning = "radiance that stands for all light of more than one bounce. --max-depth 1 leaves it out",
       .placeholder = "R,G,B",
       .initial = "hybrid: estimated from the direct light in the picture; whitted: black",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused},
      {.name = "branching",
       .value = ChoiceValue{&S::branching, kBranchingNames},
       .meaning =
           "rays that follow at mirrors and glass. tree: reflection and refraction. choice: one of them, at random",
       .group = SettingGroup::others,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .label = "branching",
       .study = {"tree", "choice"}},
      {.name = "techniques",
       .value = SpecialValue{read_techniques, techniques_text},
       .meaning = fmt::format("ways to find light, separated by commas: {}. Light that none of them finds is missing",
                              fmt::join(kTechniqueNames, ", ")),
       .placeholder = "LIST",
       .initial = "all",
       .group = SettingGroup::others,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused},
      {.name = "cutoff",
       .value = NumberValue{&S::cutoff, 0.0, 1.0},
       .meaning = "weight up to which rays are not followed. 0: all are followed",
       .placeholder = "W",
       .initial = "0.00390625 (1/256)",
       .group = SettingGroup::others,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused},
      {.name = "mips",
       .value = OnOffValue{&S::mips},
       .meaning = "mip levels of textures, in frames of one sample per pixel and in a window while the camera moves. "
                  "They keep distant textures calm, and are biased. Renders of more samples never use them",
       .group = SettingGroup::hybrid,
       .advanced = true,
       .supported_by = SupportedBy::listed_else_refused,
       .identity = [](const S& s) { return std::string(uses_mips(s) ? "on, for one sample"
                                                       : s.mips     ? "on"
                                                                    : "off"); }},
      {.name = "denoise",
       .value = ChoiceValue{&S::denoise, kDenoiseNames, "on"},
       .meaning = "noise filter, which is biased. hybrid and ao filter every frame, over space and time. The others "
                  "filter the finished picture; an EXR then holds channels denoised.R,G,B beside R,G,B. oidn: Intel's "
                  "Open Image Denoise, if it is installed",
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

std::string flags_of(const RenderSettings& settings) {
  std::string flags;
  for (const Setting& row : settings_table()) {
    const bool copied = row.always_copied || (row.decides == Decides::picture && !is_default(row, settings));
    if (!copied || !is_supported(row, *settings.integrator)) continue;
    if (const std::string flag = flag_text(row, settings); !flag.empty()) flags += " " + flag;
  }
  return flags;
}

} // namespace wavepath
