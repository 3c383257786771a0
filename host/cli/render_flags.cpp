// Settings and outputs from the command line.
#include "host/cli/render_flags.h"

#include <algorithm>
#include <limits>
#include <span>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/cli/flags.h"
#include "host/integrators/hybrid/hybrid.h"
#include "host/render/integrator.h"
#include "host/render/stats.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kLargestSide = 65536;
constexpr std::uint32_t kMostSamples = std::numeric_limits<std::int32_t>::max(); // what EXR attributes hold
constexpr std::uint32_t kOpenEndedSamples = 65536; // when time or error is to end the render
constexpr std::uint32_t kDeepest = 4096;
constexpr std::string_view kOnOff[] = {"off", "on"};
constexpr std::string_view kBvhNames[] = {"auto", "fast", "balanced", "best"};
constexpr std::string_view kAovs[] = {"albedo",  "normal", "depth",    "position", "variance",
                                      "samples", "direct", "indirect", "emission", "ao"};

const std::vector<std::string_view>& integrator_names() {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names;
    for (const IntegratorKind* kind : integrators()) names.push_back(kind->name);
    return names;
  }();
  return kNames;
}

// Parts of "A<separator>B".
std::pair<FlagValue, FlagValue> split(const FlagValue& value, char separator, const char* remedy) {
  const std::size_t middle = value.text.find(separator);
  if (middle == std::string::npos) value.refuse("has the wrong form", remedy);
  return {{value.flag, value.text.substr(0, middle)}, {value.flag, value.text.substr(middle + 1)}};
}

void read_samples(const FlagValue& value, RenderRequest& request) {
  const auto [first, last] = split(value, ':', "write it as A:B, such as 0:64");
  request.samples = {first.whole_number(0, kMostSamples), last.whole_number(0, kMostSamples)};
  if (request.samples->first >= request.samples->second) value.refuse("is an empty range", "give A:B with A below B");
}

void read_aovs(const FlagValue& value, std::vector<std::string>& aovs) {
  aovs.clear();
  for (std::size_t first = 0; first <= value.text.size();) {
    const std::size_t end = std::min(value.text.find(',', first), value.text.size());
    const FlagValue name{value.flag, value.text.substr(first, end - first)};
    name.choice(kAovs);
    if (std::find(aovs.begin(), aovs.end(), name.text) == aovs.end()) aovs.push_back(name.text);
    first = end + 1;
  }
}

} // namespace

void read_size(const FlagValue& value, RenderSettings& settings) {
  const auto [width, height] = split(value, 'x', "write it as WIDTHxHEIGHT, such as 1280x720");
  settings.width = width.whole_number(1, kLargestSide);
  settings.height = height.whole_number(1, kLargestSide);
}

void add_stop_flags(CLI::App& app, RenderRequest& request) {
  RenderSettings& settings = request.settings;
  const char* group = "When to stop (the first one reached)";
  add_flag(app, group, {"--spp", "N", "samples per pixel", "64; 65536 where only --time or --target-error is given"},
           [&](const FlagValue& value) { request.spp = value.whole_number(1, kMostSamples); });
  add_flag(app, group, {"--time", "SECONDS", "rendering time in seconds, without loading and compiling", "no limit"},
           [&](const FlagValue& value) { settings.time_limit = value.positive_number(); });
  add_flag(
      app, group,
      {"--target-error", "E", "estimated relative RMS error, 0.01 = 1 %; exit code 3 if it was not reached", "none"},
      [&](const FlagValue& value) { settings.target_error = value.positive_number(); });
  add_flag(
      app, group,
      {"--samples", "A:B",
       "render only sample indices A <= s < B, for splitting and merging; give every part the whole's --spp", "0:spp"},
      [&](const FlagValue& value) { read_samples(value, request); });
  add_switch(
      app, group,
      {"--adaptive", "",
       "more samples where a pilot finds more noise; --spp is then the average. Unbiased: the pilot is thrown away",
       "off"},
      settings.adaptive);
  add_switch(app, group,
             {"--mergeable", "", "keep exact sums in .exr outputs for 'wavepath merge'; --samples implies it", "off"},
             request.mergeable);
  add_flag(app, group, {"--checkpoint", "FILE", "save the exact state every 30 s, on interrupt and at the end", "none"},
           [&](const FlagValue& value) { request.state.file = value.text; });
  add_flag(app, group, {"--checkpoint-interval", "SECONDS", "between saves", "30"},
           [&](const FlagValue& value) { request.state.interval = value.number(0.0, 1e9); });
  add_switch(app, group,
             {"--resume", "",
              "go on from --checkpoint to the same bits as without the stop, or begin if the file is not there; a "
              "larger --spp "
              "goes on beyond the end. --time counts all rendering, before and after",
              "off"},
             request.state.resume);
  add_switch(app, group,
             {"--strict", "",
              "refuse anything biased but the depth asked for; exit code 1 if any sample was not finite", "off"},
             request.strict);
}

void add_render_flags(CLI::App& app, RenderRequest& request) {
  RenderSettings& settings = request.settings;
  const auto choose = [](std::uint32_t& target, std::span<const std::string_view> names) {
    return [&target, names](const FlagValue& value) { target = value.choice(names); };
  };
  const char* group = "Light transport";
  add_flag(app, group,
           {"--max-depth", "N", "longest path in bounces: 0 = emission seen directly, 1 = direct light, ...", "8"},
           [&](const FlagValue& value) { settings.max_depth = value.whole_number(0, kDeepest); });
  add_flag(app, group, {"--sampler", "independent|stratified|sobol", "sample points; sobol is Owen-scrambled", "sobol"},
           choose(settings.sampler, kSamplerNames));
  add_flag(app, group, {"--hemisphere", "cosine|uniform", "how diffuse directions are sampled", "cosine"},
           choose(settings.hemisphere, kHemisphereNames));
  add_flag(
      app, group,
      {"--direct", "mis|nee|bsdf", "direct light by both techniques, by light sampling, or by BSDF sampling", "mis"},
      choose(settings.direct, kDirectNames));
  add_flag(app, group, {"--seed", "N", "another seed gives another noise, the same seed the same bits", "0"},
           [&](const FlagValue& value) { settings.seed = value.whole_number(0, kMostSamples); });
  add_flag(app, group,
           {"--bvh", "auto|fast|balanced|best",
            "tree over the triangles; a better one takes longer to build and gives the same image sooner",
            "auto: what pays for the number of rays"},
           [&](const FlagValue& value) {
             const std::uint32_t chosen = value.choice(kBvhNames);
             request.bvh = chosen ? std::optional(static_cast<bvh::Quality>(chosen - 1)) : std::nullopt;
           });
  add_flag(app, group,
           {"--device", "NAME|INDEX", "Vulkan device; 'wavepath info' lists them", "a discrete GPU if there is one"},
           [&](const FlagValue& value) { request.device = value.text; });
  add_flag(app, group,
           {"--specialize", "on|off", "leave out what the scene does not need; off gives the same image, slower", "on"},
           [&](const FlagValue& value) { settings.specialize = value.choice(kOnOff) != 0; });
}

void add_hybrid_flags(CLI::App& app, RenderRequest& request) {
  RenderSettings& settings = request.settings;
  const char* group = "Hybrid rendering (--integrator hybrid or ao); a sample per pixel is a frame";
  add_flag(app, "Light transport",
           {"--integrator", "path|hybrid|ao",
            "path tracing; hybrid: rasterized first hit, traced direct light and ambient occlusion; or that occlusion alone",
            "path"},
           [&](const FlagValue& value) { settings.integrator = integrators()[value.choice(integrator_names())]; });
  constexpr double kMostRadiance = 1e30; // sums with direct light stay finite
  add_flag(app, group, {"--shadow-samples", "N", "light samples a pixel and frame, stratified", "1"},
           [&](const FlagValue& value) { settings.shadow_samples = value.whole_number(1, kMostFrameRays); });
  add_flag(app, group, {"--ao-samples", "N", "occlusion rays a pixel and frame, cosine-weighted and stratified", "1"},
           [&](const FlagValue& value) { settings.ao_samples = value.whole_number(1, kMostFrameRays); });
  add_flag(app, group,
           {"--ao-radius", "METRES", "distance from which on nothing occludes; 0 = unlimited",
            "hybrid: a tenth of the scene's radius; ao: 0"},
           [&](const FlagValue& value) { settings.ao_radius = value.number(0.0, 1e30); });
  add_flag(app, group,
           {"--ambient", "R,G,B", "radiance that stands for all light of more than one bounce; --max-depth 1 leaves it out",
            "estimated from the direct light in the picture"},
           [&](const FlagValue& value) {
             const glm::dvec3 radiance = value.triple();
             if (glm::any(glm::lessThan(radiance, glm::dvec3(0.0)))) value.refuse("is negative", "give radiance of zero or more");
             if (glm::any(glm::greaterThan(radiance, glm::dvec3(kMostRadiance))))
               value.refuse("is too large", "give at most 1e30");
             settings.ambient = glm::vec3(radiance);
           });
  add_switch(app, group,
             {"--denoise", "", "filter direct light and occlusion over space and time (SVGF); fast, and biased", "off"},
             settings.denoise);
}

void add_picture_flags(CLI::App& app, RenderRequest& request) {
  const char* group = "Picture";
  add_flag(app, group, {"--size", "WxH", "pixels", "1280x720"},
           [&](const FlagValue& value) { read_size(value, request.settings); });
  add_flag(app, group,
           {"--filter", "box|gaussian|blackman-harris", "pixel filter, importance-sampled",
            "blackman-harris; box if --reference is box-filtered"},
           [&](const FlagValue& value) { request.filter = value.choice(kFilterNames); });
  add_flag(app, group,
           {"--origin", "X,Y,Z", "where in the scene single precision is finest, world units; decides last bits alone",
            "the eye"},
           [&](const FlagValue& value) { request.origin = value.triple(); });
  add_flag(
      app, group,
      {"--aov", "LIST",
       "extra EXR channels, separated by commas: albedo, normal, depth, position, variance, samples, direct, indirect, "
       "emission; ao with --integrator hybrid or ao",
       "none"},
      [&](const FlagValue& value) { read_aovs(value, request.settings.aovs); });
}

void add_replay_flags(CLI::App& app, RenderRequest& request) {
  const char* group = "One path instead of a picture";
  add_flag(app, group,
           {"--pixel", "X,Y", "trace one path of this pixel, counted from the top left, and print it; needs --sample"},
           [&](const FlagValue& value) {
             const auto [x, y] = split(value, ',', "write it as X,Y, such as 640,360");
             request.pixel = glm::uvec2(x.whole_number(0, kLargestSide), y.whole_number(0, kLargestSide));
           });
  add_flag(app, group, {"--sample", "N", "which path of the pixel; all other flags as in the render it belongs to"},
           [&](const FlagValue& value) { request.sample = value.whole_number(0, kMostSamples); });
}

void add_tone_flags(CLI::App& app, WriteOptions& options) {
  const char* group = "Output";
  add_flag(app, group, {"--exposure", "EV", "brighten tonemapped outputs by this many stops", "0"},
           [&](const FlagValue& value) { options.exposure = value.number(-64.0, 64.0); });
  add_flag(app, group, {"--tonemap", "none|aces|agx|neutral", "tone curve of .png and .jpg outputs", "neutral"},
           [&](const FlagValue& value) { options.tonemap = static_cast<Tonemap>(value.choice(kTonemapNames)); });
}

void add_picture_output_flags(CLI::App& app, OutputRequest& request, const char* initial) {
  const char* group = "Output";
  add_flag(
      app, group,
      {"-o,--output", "FILE", "repeatable; .exr and .hdr linear, .png and .jpg tonemapped", initial},
      [&](const FlagValue& value) { request.pictures.push_back(value.text); }, true);
  add_switch(app, group, {"--half", "", "EXR with 16-bit floats", "off: 32-bit"}, request.write.half);
  add_tone_flags(app, request.write);
}

void add_output_flags(CLI::App& app, OutputRequest& request) {
  const char* group = "Output";
  const auto keep = [](std::string& text) { return [&text](const FlagValue& value) { text = value.text; }; };
  add_picture_output_flags(app, request, "SCENE-stem.exr");
  add_flag(app, group,
           {"--stats", "FILE.json", "write everything that the run measured, time to the first pixel included",
            "not written"},
           keep(request.stats));
  add_flag(app, group, {"--reference", "FILE.exr", "also measure the true error at every checkpoint", "none"},
           keep(request.reference));
  add_switch(app, group, {"--json", "", "print the stats document on stdout", "off"}, request.json);
  add_switch(app, group, {"-q,--quiet", "", "no progress and no summary", "off"}, request.quiet);
  add_switch(app, group,
             {"-v,--verbose", "", "say more on stderr: device, memory, seconds by stage, what is left out", "off"},
             request.verbose);
}

void settle_samples(RenderRequest& request) {
  RenderSettings& settings = request.settings;
  if (request.state.resume && request.state.file.empty())
    throw UsageError("--resume", "there is nothing to resume from", "name the state with --checkpoint FILE");
  if (settings.adaptive && (request.samples || request.mergeable))
    throw UsageError("--adaptive", "does not share its samples out evenly, so parts of it cannot be merged",
                     "leave out --adaptive, or --samples and --mergeable");
  request.mergeable |= request.samples.has_value();
  const bool open_ended = settings.time_limit > 0.0 || settings.target_error > 0.0;
  settings.first_sample = 0;
  settings.last_sample = request.spp.value_or(open_ended ? kOpenEndedSamples : settings.last_sample);
  if (!request.samples) return;
  std::tie(settings.first_sample, settings.last_sample) = *request.samples;
  settings.sample_total = request.spp.value_or(0); // parts of one render give --spp, so that they share its strata
  if (request.spp && settings.last_sample > *request.spp)
    throw UsageError("--samples", fmt::format("{} ends beyond --spp {}", settings.last_sample, *request.spp),
                     "give a range within 0:spp");
}

void check_integrator(const RenderRequest& request) {
  const RenderSettings& settings = request.settings;
  const bool path = settings.integrator->traces_paths;
  const std::string flag = fmt::format("--integrator {}", settings.integrator->name);
  if (path && settings.denoise)
    throw UsageError("--denoise", "filters what hybrid rendering traces", "add --integrator hybrid or ao");
  if (path && std::ranges::count(settings.aovs, "ao"))
    throw UsageError("--aov ao", "is not known to path tracing", "add --integrator hybrid or ao");
  if (path) return;
  if (settings.adaptive)
    throw UsageError("--adaptive", "shares out paths, and frames have the same samples everywhere",
                     "leave it out, or use --integrator path");
  if (request.pixel) throw UsageError("--pixel", "replays paths, not frames", "use --integrator path");
  if (request.strict && settings.integrator->is_biased(settings))
    throw UsageError(flag, "is biased, which --strict refuses",
                     settings.denoise ? "leave out --denoise" : "use --integrator path, or --max-depth 1 for direct light");
  if (settings.denoise && (request.mergeable || !request.state.file.empty()))
    throw UsageError("--denoise", "makes every frame depend on those before, which no file keeps",
                     "leave it out, or --checkpoint, --samples and --mergeable");
}

void check_replay(const RenderRequest& request) {
  const RenderSettings& settings = request.settings;
  if (request.pixel.has_value() != request.sample.has_value())
    throw UsageError(request.pixel ? "--pixel" : "--sample", "names no path alone", "give --pixel X,Y and --sample N");
  if (!request.pixel) return;
  if (request.pixel->x >= settings.width || request.pixel->y >= settings.height)
    throw UsageError(
        "--pixel",
        fmt::format("{},{} is outside the picture of {}x{}", request.pixel->x, request.pixel->y, settings.width,
                    settings.height),
        fmt::format("stay within {},{}, or give the --size of the render", settings.width - 1, settings.height - 1));
  if (*request.sample < settings.first_sample || *request.sample >= settings.last_sample)
    throw UsageError("--sample",
                     fmt::format("{} is not in {}:{}", *request.sample, settings.first_sample, settings.last_sample),
                     "give the --spp or --samples of the render");
}

} // namespace wavepath
