// Settings and outputs from the command line.
#include "host/cli/render_flags.h"

#include <algorithm>
#include <array>
#include <limits>
#include <sstream>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/cli/scene_flags.h"
#include "host/gpu/context.h"
#include "host/gpu/device_choice.h"
#include "host/picture/filter/oidn.h"
#include "host/render/settings/antialias_settings.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/levels.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kLargestIndex = std::numeric_limits<std::int32_t>::max(); // of pixels and samples
constexpr std::uint32_t kMostTrainingPaths = 1u << 24, kMostGuideIterations = 6;
constexpr std::string_view kBvhNames[] = {"auto", "fast", "balanced", "best"};

constexpr const char* heading_of(SettingGroup group) {
  switch (group) {
    case SettingGroup::picture:
      return "Picture";
    case SettingGroup::lens:
      return "Camera";
    case SettingGroup::stop:
      return "End of the render (the limit that is reached first)";
    case SettingGroup::parts:
      return "Split and resumed renders";
    case SettingGroup::transport:
      return "Light transport";
    case SettingGroup::speed:
      return "Device and speed";
    case SettingGroup::decisions:
      return "Sampling (the defaults suit most scenes)";
    case SettingGroup::hybrid:
      return "Integrators hybrid and ao";
    case SettingGroup::shadows:
      return "Shadow techniques of hybrid";
    case SettingGroup::occlusion:
      return "Ambient occlusion of hybrid and ao";
    case SettingGroup::reflections:
      return "Reflections of hybrid";
    case SettingGroup::shading:
      return "Local shading of hybrid";
    case SettingGroup::transparency:
      return "Transparency of hybrid";
    case SettingGroup::others:
      return "Integrators whitted and bidirectional";
  }
  return "";
}

constexpr std::array kOfRender = {
    HelpOverride{.name = "integrator", .initial = "auto, or path if another flag needs it"}};

const HelpOverride* find(std::span<const HelpOverride> help_overrides, std::string_view name) {
  const auto found = std::ranges::find(help_overrides, name, &HelpOverride::name);
  return found == help_overrides.end() ? nullptr : &*found;
}

Flag flag_of(const Setting& row, Offer command, const HelpOverride* help_override) {
  const std::vector<std::string_view> names = choices_of(row);
  const bool is_switch = std::holds_alternative<SwitchValue>(row.value);
  Flag flag{fmt::format("--{}", row.name),
            is_switch                                   ? ""
            : names.empty() || !row.placeholder.empty() ? row.placeholder
                                                        : fmt::format("{}", fmt::join(names, "|")),
            help_override && help_override->meaning ? help_override->meaning : row.meaning,
            row.initial.empty() ? text_of(row, RenderSettings{}) : row.initial, row.advanced};
  if (help_override && help_override->initial) flag.initial = help_override->initial;
  const bool by_all =
      std::ranges::all_of(integrators(), [&](const IntegratorKind* kind) { return is_supported(row, *kind); });
  if (!by_all && (setting_named("integrator").offered & command))
    flag.meaning += fmt::format(". Only with --integrator {}", supporters_text(row.name));
  return flag;
}

void add_transport_settings(CLI::App& app, Offer command, RenderRequest& request) {
  for (const SettingGroup group :
       {SettingGroup::transport, SettingGroup::speed, SettingGroup::decisions, SettingGroup::hybrid,
        SettingGroup::shadows, SettingGroup::occlusion, SettingGroup::reflections, SettingGroup::shading,
        SettingGroup::transparency, SettingGroup::others})
    add_settings(app, command, group, request,
                 command == kByRender ? std::span<const HelpOverride>(kOfRender) : std::span<const HelpOverride>());
}

} // namespace

std::vector<std::string> spelled_out(std::vector<std::string> words) {
  for (const Setting& row : settings_table()) {
    const auto* kind = std::get_if<ChoiceValue>(&row.value);
    if (!kind || kind->bare.empty()) continue;
    const std::string flag = fmt::format("--{}", row.name);
    for (std::size_t i = 0; i < words.size(); ++i)
      if (words[i] == flag && (i + 1 == words.size() || std::ranges::count(kind->names, words[i + 1]) == 0))
        words[i] += fmt::format("={}", kind->bare);
  }
  return words;
}

void add_settings(CLI::App& app, Offer command, SettingGroup group, RenderRequest& request,
                  std::span<const HelpOverride> help_overrides, const char* heading) {
  if (!heading) heading = heading_of(group);
  for (const Setting& row : settings_table()) {
    if (row.group != group || !(row.offered & command)) continue;
    const HelpOverride* help_override = find(help_overrides, row.name);
    const std::uint32_t highest = help_override ? help_override->highest : 0;
    const auto read = [&row, &request, highest](const FlagValue& value) {
      if (highest > 0) value.whole_number(0, highest);
      read_setting(row, value.text, request.settings);
      request.given.push_back(row.name);
    };
    if (std::holds_alternative<SwitchValue>(row.value))
      add_switch(app, heading, flag_of(row, command, help_override), [read](bool on) {
        read(FlagValue{{}, on ? "on" : "off"});
      });
    else
      add_flag(app, heading, flag_of(row, command, help_override), read);
  }
}

void add_settings_of_render(CLI::App& app, RenderRequest& request) {
  for (const SettingGroup group : {SettingGroup::picture, SettingGroup::lens, SettingGroup::stop, SettingGroup::parts})
    add_settings(app, kByRender, group, request);
  add_transport_settings(app, kByRender, request);
}

void add_stop_flags(CLI::App& app, RenderRequest& request) {
  add_settings(app, kByRender, SettingGroup::stop, request);
  add_settings(app, kByRender, SettingGroup::parts, request);
  const char* group = heading_of(SettingGroup::parts);
  add_switch(app, group,
             {"--mergeable", "", "store exact sums in .exr outputs, for 'wavepath merge'. --samples implies it", "off"},
             request.mergeable);
  add_flag(app, group,
           {"--checkpoint", "FILE", "state file of the render, saved every 30 s, on interrupt and at the end", "none"},
           [&](const FlagValue& value) { request.state.file = value.text; });
  add_flag(app, group, {"--checkpoint-interval", "SECONDS", "time between saves of --checkpoint", "30", kAdvanced},
           [&](const FlagValue& value) { request.state.interval = value.number(0.0, 1e9); });
  add_switch(app, group,
             {"--resume", "",
              "continue from --checkpoint, to the same bits as without a stop. If the file does not exist, the render "
              "starts anew. A larger --spp adds samples, with the decisions of the shorter render. --time counts the "
              "time before and after the stop",
              "off"},
             request.state.resume);
}

void add_bvh_flag(CLI::App& app, RenderRequest& request) {
  add_flag(app, heading_of(SettingGroup::speed),
           {"--bvh", "auto|fast|balanced|best",
            "quality of the BVH. A better BVH takes longer to build and traces rays faster. The picture is the same",
            "auto: by the number of rays", kAdvanced},
           [&](const FlagValue& value) {
             const std::uint32_t chosen = value.choice(kBvhNames);
             request.bvh = chosen ? std::optional(static_cast<bvh::Quality>(chosen - 1)) : std::nullopt;
           });
}

void add_device_flag(CLI::App& app, RenderRequest& request, const char* heading) {
  add_flag(app, heading ? heading : heading_of(SettingGroup::speed),
           {"--device", "NAME|INDEX", "Vulkan device. 'wavepath info' lists them", "a discrete GPU if there is one"},
           [&](const FlagValue& value) { request.device = value.text; });
}

void add_devices_flag(CLI::App& app, RenderRequest& request) {
  add_flag(app, heading_of(SettingGroup::speed),
           {"--devices", "LIST|all",
            "devices that render one picture together: names or indices as for --device, separated by commas", "one"},
           [&](const FlagValue& value) { request.devices = value.text; });
}

void add_picture_flags(CLI::App& app, Offer command, RenderRequest& request) {
  add_settings(app, command, SettingGroup::picture, request);
  add_settings(app, command, SettingGroup::lens, request);
  add_flag(app, heading_of(SettingGroup::picture),
           {"--origin", "X,Y,Z",
            "point of the scene where single precision is finest, in world units. It changes only last bits", "the eye",
            kAdvanced},
           [&](const FlagValue& value) { request.origin = value.triple(); });
}

void add_transport_flags(CLI::App& app, Offer command, RenderRequest& request) {
  add_transport_settings(app, command, request);
  if (command == kByRender)
    add_switch(app, heading_of(SettingGroup::transport),
               {"--strict", "",
                "refuse everything biased except --max-depth; bidirectional leaves out merge. Exit code 1 if any "
                "sample was not finite",
                "off"},
               request.strict);
  add_bvh_flag(app, request);
  add_device_flag(app, request);
}

void add_plan_flags(CLI::App& app, RenderRequest& request) {
  const char* group = "Plan of an earlier render";
  add_flag(app, group,
           {"--plan", "FILE",
            "use the decisions of an earlier render, from its .exr, its --checkpoint or its --stats .json, instead of "
            "pilots",
            "pilots decide"},
           [&](const FlagValue& value) { request.plan_file = value.text; });
  add_flag(app, group,
           {"--training-paths", "N", "paths of the training on lights. 0: as many as in parts of a render",
            "by the length of the render", kAdvanced},
           [&](const FlagValue& value) { request.training_paths = value.whole_number(0, kMostTrainingPaths); });
  add_flag(
      app, group,
      {"--guide-iterations", "N", "iterations of the training of --guide", "by the length of the render", kAdvanced},
      [&](const FlagValue& value) { request.guide_iterations = value.whole_number(1, kMostGuideIterations); });
}

void add_replay_flags(CLI::App& app, RenderRequest& request) {
  const char* group = "Trace of one path";
  add_flag(app, group,
           {"--pixel", "X,Y", "pixel, counted from the top left. Its path number --sample is traced and printed"},
           [&](const FlagValue& value) {
             const auto [x, y] = value.split(',', "write it as X,Y, such as 640,360");
             request.pixel = glm::uvec2(x.whole_number(0, kLargestIndex), y.whole_number(0, kLargestIndex));
           });
  add_flag(app, group, {"--sample", "N", "index of the path in the pixel. All other flags must be those of the render"},
           [&](const FlagValue& value) { request.sample = value.whole_number(0, kLargestIndex); });
  add_flag(app, group,
           {"--net", "N", "sample stream of the path. 0: of all pixels. 1: of error probes", "0", kAdvanced},
           [&](const FlagValue& value) { request.replicate = value.whole_number(0, 1); });
}

void add_tone_flags(CLI::App& app, WriteOptions& options) {
  const char* group = "Output";
  options.exposure.reset();
  add_flag(app, group,
           {"--exposure", "EV|auto",
            "exposure of tonemapped outputs, in stops. auto: a middle grey on average, but at most 5 % of the picture "
            "above white; the value is printed",
            "auto"},
           [&](const FlagValue& value) {
             options.exposure = value.text == "auto" ? std::nullopt : std::optional(value.number(-64.0, 64.0));
           });
  add_flag(app, group, {"--tonemap", "none|aces|agx|neutral", "tone curve of .png and .jpg outputs", "neutral"},
           [&](const FlagValue& value) { options.tonemap = static_cast<Tonemap>(value.choice(kTonemapNames)); });
}

void add_layout_flags(CLI::App& app, const char* group, WriteOptions& options, bool hides) {
  add_switch(app, group, {"--half", "", "store 16-bit floats in EXR files", "off: 32-bit"}, options.half);
  add_flag(app, group,
           {"--layers", "plain|blender",
            "names of the channels of EXR files. blender: those of Blender's passes, such as ViewLayer.Combined.R. "
            "merge, compare, --reference and --plan read both",
            "plain"},
           [&options](const FlagValue& value) { options.layers = static_cast<LayerNames>(value.choice(kLayerNames)); });
  add_flag(app, group,
           {"--compression", "zip|zips|piz|dwaa|none",
            "compression of EXR files. dwaa loses precision, and only of colours: normals, positions, other data and "
            "the sums for 'wavepath merge' then stand in a second part of the file, by zip",
            "zip", hides},
           [&options](const FlagValue& value) {
             options.compression = static_cast<Compression>(value.choice(kCompressionNames));
           });
  add_switch(app, group, {"--multi-part", "", "give each layer of EXR files a part of its own", "off: one part", hides},
             options.multi_part);
  add_flag(app, group, {"--bits", "8|16", "bits of each channel of .png outputs", "8", hides},
           [&options](const FlagValue& value) {
             constexpr std::string_view kBits[] = {"8", "16"};
             options.bits = value.choice(kBits) == 0 ? 8 : 16;
           });
}

std::string layout_flags(const WriteOptions& options, std::span<const std::string> pictures) {
  std::string flags;
  const auto has = [&](PictureFormat format) { return std::ranges::count(pictures, format, picture_format) > 0; };
  if (has(PictureFormat::exr)) {
    if (options.half) flags += " --half";
    if (options.layers != LayerNames::plain)
      flags += fmt::format(" --layers {}", kLayerNames[static_cast<std::size_t>(options.layers)]);
    if (options.compression != Compression::zip)
      flags += fmt::format(" --compression {}", kCompressionNames[static_cast<std::size_t>(options.compression)]);
    if (options.multi_part) flags += " --multi-part";
  } else if (has(PictureFormat::png) && options.bits != 8) {
    flags += fmt::format(" --bits {}", options.bits);
  }
  return flags;
}

void add_picture_output_flags(CLI::App& app, OutputRequest& request, const char* initial, bool hides) {
  const char* group = "Output";
  add_flag(
      app, group,
      {"-o,--output", "FILE", "picture to write; repeatable. .exr and .hdr are linear, .png and .jpg are tonemapped",
       initial},
      [&](const FlagValue& value) { request.pictures.push_back(value.text); }, true);
  WriteOptions& write = request.write;
  add_layout_flags(app, group, write, hides);
  add_tone_flags(app, write);
}

void check_write_options(const OutputRequest& request) {
  const WriteOptions& write = request.write;
  const auto require_one = [&](bool given, const char* flag, PictureFormat format, const char* extension) {
    if (!given || std::ranges::count(request.pictures, format, picture_format) > 0) return;
    throw UsageError(flag, fmt::format("is for {} files, and {} is none", extension, fmt::join(request.pictures, ", ")),
                     fmt::format("add -o FILE{}, or leave out {}", extension, flag));
  };
  require_one(write.bits != 8, "--bits", PictureFormat::png, ".png");
  require_one(write.layers != LayerNames::plain, "--layers", PictureFormat::exr, ".exr");
  require_one(write.compression != Compression::zip, "--compression", PictureFormat::exr, ".exr");
  require_one(write.multi_part, "--multi-part", PictureFormat::exr, ".exr");
}

void add_output_flags(CLI::App& app, OutputRequest& request) {
  const char* group = "Output";
  const auto keep = [](std::string& text) { return [&text](const FlagValue& value) { text = value.text; }; };
  add_picture_output_flags(app, request, "SCENE-stem.exr", true);
  add_flag(
      app, group,
      {"--stats", "FILE.json", "JSON file of all measurements, including the time to the first pixel", "not written"},
      keep(request.stats));
  add_flag(app, group,
           {"--reference", "FILE.exr", "converged picture. The true error is measured at every checkpoint", "none"},
           keep(request.reference));
  add_flag(
      app, group,
      {"--tev", "HOST[:PORT]", "viewer tev, which shows the picture during the render. Without PORT: 14158", "off"},
      keep(request.tev));
  add_flag(app, group,
           {"--save-every", "SECONDS",
            "time between pictures of the render so far: all -o and --stats files are replaced as a whole, at a moment "
            "when all pixels have the same samples",
            "at the end alone"},
           [&](const FlagValue& value) { request.save_every = value.positive_number(); });
  add_switch(app, group, {"--json", "", "print the stats as JSON on stdout", "off"}, request.json);
  add_switch(app, group, {"-q,--quiet", "", "print no progress and no summary", "off"}, request.quiet);
  add_switch(
      app, group,
      {"-v,--verbose", "", "print more on stderr: device, memory, decisions, seconds by stage, unused features", "off"},
      request.verbose);
}

} // namespace wavepath
