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
#include "host/render/adaptive_choice.h"
#include "host/render/reuse_choice.h"
#include "host/render/settings/antialias_settings.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/settings_table.h"
#include "host/render/sky_choice.h"
#include "host/render/workspace/levels.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kLargestIndex = std::numeric_limits<std::int32_t>::max(); // of pixels and samples
constexpr std::string_view kBvhNames[] = {"auto", "fast", "balanced", "best"};
constexpr const char* kTransport = "Light transport";

// By SettingGroup.
constexpr const char* kHeadings[] = {"Picture", "When to stop (the first one reached)", kTransport,
                                     "Settings of some integrators"};

constexpr std::array kOfRender = {
    Wording{.name = "integrator", .initial = "auto, or path where a flag asks for what auto leaves out"}};

const Wording* find(std::span<const Wording> wordings, std::string_view name) {
  const auto found = std::ranges::find(wordings, name, &Wording::name);
  return found == wordings.end() ? nullptr : &*found;
}

Flag flag_of(const Setting& row, Offer command, const Wording* wording) {
  const std::vector<std::string_view> names = choices_of(row);
  const bool is_switch = std::holds_alternative<SwitchValue>(row.value);
  Flag flag{fmt::format("--{}", row.name),
            is_switch                                   ? ""
            : names.empty() || !row.placeholder.empty() ? row.placeholder
                                                        : fmt::format("{}", fmt::join(names, "|")),
            wording && wording->meaning ? wording->meaning : row.meaning,
            row.initial.empty() ? text_of(row, RenderSettings{}) : row.initial};
  if (wording && wording->initial) flag.initial = wording->initial;
  if (row.takers != Takers::all && (setting_named("integrator").offered & command))
    flag.meaning += fmt::format("; only with --integrator {}", takers_text(row.name));
  return flag;
}

[[noreturn]] void refuse_not_taken(const std::string& flag, const RenderSettings& settings, const std::string& takers) {
  throw UsageError(flag, fmt::format("is not taken by --integrator {}", settings.integrator->name),
                   fmt::format("use --integrator {}, or leave it out", takers));
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

bool is_given(const RenderRequest& request, std::string_view setting) {
  return std::ranges::count(request.given, setting) > 0;
}

void add_settings(CLI::App& app, Offer command, SettingGroup group, RenderRequest& request,
                  std::span<const Wording> wordings, const char* heading) {
  if (!heading) heading = kHeadings[static_cast<std::size_t>(group)];
  for (const Setting& row : settings_table()) {
    if (row.group != group || !(row.offered & command)) continue;
    const Wording* wording = find(wordings, row.name);
    const std::uint32_t highest = wording ? wording->highest : 0;
    const auto read = [&row, &request, highest](const FlagValue& value) {
      if (highest > 0) value.whole_number(0, highest);
      read_setting(row, value.text, request.settings);
      request.given.push_back(row.name);
    };
    if (std::holds_alternative<SwitchValue>(row.value))
      add_switch(app, heading, flag_of(row, command, wording), [read](bool on) {
        read(FlagValue{{}, on ? "on" : "off"});
      });
    else
      add_flag(app, heading, flag_of(row, command, wording), read);
  }
}

void add_settings_of_render(CLI::App& app, RenderRequest& request) {
  for (const SettingGroup group :
       {SettingGroup::picture, SettingGroup::stop, SettingGroup::transport, SettingGroup::special})
    add_settings(app, kByRender, group, request, kOfRender);
}

void add_stop_flags(CLI::App& app, RenderRequest& request) {
  add_settings(app, kByRender, SettingGroup::stop, request);
  const char* group = kHeadings[static_cast<std::size_t>(SettingGroup::stop)];
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
              "larger --spp goes on beyond the end, by what pilots found for the shorter render. --time counts all "
              "rendering, before and after",
              "off"},
             request.state.resume);
  add_switch(app, group,
             {"--strict", "",
              "refuse anything biased but the depth asked for, and leave out merging; exit code 1 if any sample was "
              "not finite",
              "off"},
             request.strict);
}

void add_bvh_flag(CLI::App& app, RenderRequest& request) {
  add_flag(app, kTransport,
           {"--bvh", "auto|fast|balanced|best",
            "tree over the triangles; a better one takes longer to build and gives the same image sooner",
            "auto: what pays for the number of rays"},
           [&](const FlagValue& value) {
             const std::uint32_t chosen = value.choice(kBvhNames);
             request.bvh = chosen ? std::optional(static_cast<bvh::Quality>(chosen - 1)) : std::nullopt;
           });
}

void add_device_flag(CLI::App& app, RenderRequest& request, const char* heading) {
  add_flag(app, heading ? heading : kTransport,
           {"--device", "NAME|INDEX", "Vulkan device; 'wavepath info' lists them", "a discrete GPU if there is one"},
           [&](const FlagValue& value) { request.device = value.text; });
}

void add_devices_flag(CLI::App& app, RenderRequest& request) {
  add_flag(app, kTransport,
           {"--devices", "LIST|all", "several devices render one picture: as for --device, separated by commas", "one"},
           [&](const FlagValue& value) { request.devices = value.text; });
}

void settle_devices(RenderRequest& request) {
  if (request.devices.empty()) return;
  const auto refuse = [&](bool given, const char* flag, const char* why) {
    if (given)
      throw UsageError("--devices", fmt::format("does not go with {}, {}", flag, why), "leave out one of them");
  };
  refuse(!request.device.empty(), "--device", "which names one");
  refuse(!request.state.file.empty(), "--checkpoint", "whose state is that of one device");
  refuse(request.settings.adaptive == kAdaptiveOn, "--adaptive", "whose samples are not shared out evenly");
  refuse(request.pixel.has_value(), "--pixel", "which renders one path");
  const std::vector<DeviceInfo> known = list_devices();
  std::vector<std::string> wanted;
  if (request.devices == "all") {
    const auto usable = [&](bool cpu) {
      for (std::size_t i = 0; i < known.size(); ++i)
        if (known[i].missing.empty() && (known[i].type == "cpu") == cpu) wanted.push_back(std::to_string(i));
    };
    usable(false);
    if (wanted.empty()) usable(true);         // beside a GPU a CPU would have to be waited for
    if (wanted.empty()) wanted.push_back(""); // says what is missing
  } else {
    std::istringstream list(request.devices);
    for (std::string one; std::getline(list, one, ',');)
      if (!one.empty()) wanted.push_back(std::to_string(choose_device(known, one)));
    if (wanted.empty()) throw UsageError("--devices", "names no device", "write --devices 0,1 or --devices all");
  }
  request.device = wanted.front();
  request.other_devices.assign(wanted.begin() + 1, wanted.end());
}

void add_picture_flags(CLI::App& app, Offer command, RenderRequest& request) {
  add_settings(app, command, SettingGroup::picture, request);
  add_flag(app, kHeadings[static_cast<std::size_t>(SettingGroup::picture)],
           {"--origin", "X,Y,Z", "where in the scene single precision is finest, world units; decides last bits alone",
            "the eye"},
           [&](const FlagValue& value) { request.origin = value.triple(); });
}

void add_transport_flags(CLI::App& app, Offer command, RenderRequest& request) {
  add_settings(app, command, SettingGroup::transport, request,
               command == kByRender ? std::span<const Wording>(kOfRender) : std::span<const Wording>());
  add_bvh_flag(app, request);
  add_device_flag(app, request);
  add_settings(app, command, SettingGroup::special, request);
}

void add_replay_flags(CLI::App& app, RenderRequest& request) {
  const char* group = "One path instead of a picture";
  add_flag(app, group,
           {"--pixel", "X,Y", "trace one path of this pixel, counted from the top left, and print it; needs --sample"},
           [&](const FlagValue& value) {
             const auto [x, y] = value.split(',', "write it as X,Y, such as 640,360");
             request.pixel = glm::uvec2(x.whole_number(0, kLargestIndex), y.whole_number(0, kLargestIndex));
           });
  add_flag(app, group, {"--sample", "N", "which path of the pixel; all other flags as in the render it belongs to"},
           [&](const FlagValue& value) { request.sample = value.whole_number(0, kLargestIndex); });
  add_flag(app, group, {"--net", "N", "0, or 1 for the second net of samples, which measured pixels have", "0"},
           [&](const FlagValue& value) { request.net = value.whole_number(0, 1); });
}

void add_tone_flags(CLI::App& app, WriteOptions& options) {
  const char* group = "Output";
  options.exposure.reset();
  add_flag(app, group,
           {"--exposure", "EV|auto",
            "brighten tonemapped outputs by this many stops; auto brings the picture's middle to a middle grey, keeps "
            "highlights, and tells the value",
            "auto"},
           [&](const FlagValue& value) {
             options.exposure = value.text == "auto" ? std::nullopt : std::optional(value.number(-64.0, 64.0));
           });
  add_flag(app, group, {"--tonemap", "none|aces|agx|neutral", "tone curve of .png and .jpg outputs", "neutral"},
           [&](const FlagValue& value) { options.tonemap = static_cast<Tonemap>(value.choice(kTonemapNames)); });
}

void add_picture_output_flags(CLI::App& app, OutputRequest& request, const char* initial) {
  const char* group = "Output";
  add_flag(
      app, group, {"-o,--output", "FILE", "repeatable; .exr and .hdr linear, .png and .jpg tonemapped", initial},
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
  add_flag(app, group,
           {"--tev", "HOST[:PORT]", "send the picture to the viewer tev as it progresses; port 14158 if none is named",
            "off"},
           keep(request.tev));
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
  const bool part = is_given(request, "samples");
  if (settings.adaptive == kAdaptiveOn && (part || request.mergeable))
    throw UsageError("--adaptive", "does not share its samples out evenly, so parts of it cannot be merged",
                     "leave out --adaptive, or --samples and --mergeable");
  request.mergeable |= part;
  // Parts of one render give its --spp, so that they share its strata.
  const std::uint32_t spp = settings.sample_total; // 0 = not given
  if (part && spp > 0 && settings.last_sample > spp)
    throw UsageError("--samples", fmt::format("{} ends beyond --spp {}", settings.last_sample, spp),
                     "give a range within 0:spp");
  if (part) return;
  const bool open_ended = settings.time_limit > 0.0 || settings.target_error > 0.0;
  settings.last_sample = spp > 0 ? spp : open_ended ? kOpenEndedSamples : settings.last_sample;
  settings.sample_total = 0;
}

void settle_default_integrator(RenderRequest& request) {
  RenderSettings& settings = request.settings;
  const IntegratorKind& automatic = *find_integrator("auto");
  const bool lone_part = is_given(request, "samples") && settings.sample_total == 0;
  const bool refuses_flag = std::ranges::any_of(settings_table(), [&](const Setting& row) {
    return row.takers == Takers::listed_else_refused && !is_taken(row, automatic) && !is_default(row, settings);
  });
  const bool refuses_aov = std::ranges::any_of(settings.aovs, [&](const std::string& aov) {
    return !aov_takers_text(aov).empty() && std::ranges::count(automatic.aovs, aov) == 0;
  });
  const bool replays = request.pixel.has_value() && !takes(automatic, "pixel");
  const bool asks_for_path = settings.reuse == kReuseOn; // which other integrators would drop
  if (is_given(request, "integrator") || lone_part || refuses_flag || refuses_aov || replays || asks_for_path) return;
  settings.integrator = &automatic;
}

void check_integrator(const RenderRequest& request) {
  const RenderSettings& settings = request.settings;
  const IntegratorKind& kind = *settings.integrator;
  for (const Setting& row : settings_table())
    if (row.takers == Takers::listed_else_refused && !is_taken(row, kind) && !is_default(row, settings))
      refuse_not_taken(fmt::format("--{}", row.name), settings, takers_text(row.name));
  if (kind.check) kind.check(settings);
  for (const std::string& aov : settings.aovs)
    if (const std::string takers = aov_takers_text(aov); !takers.empty() && std::ranges::count(kind.aovs, aov) == 0)
      refuse_not_taken("--aov " + aov, settings, takers);
  for (const std::string_view aov : kind.lacks_aovs)
    if (std::ranges::count(settings.aovs, aov) > 0)
      throw UsageError(fmt::format("--aov {}", aov), fmt::format("cannot be told apart by --integrator {}", kind.name),
                       "leave it out, or use --integrator path");
  if (request.pixel && !takes(kind, "pixel")) refuse_not_taken("--pixel", settings, takers_text("pixel"));
  if (request.strict && kind.is_biased(settings))
    throw UsageError(fmt::format("--integrator {}", kind.name), "is biased, which --strict refuses",
                     settings.denoise      ? "leave out --denoise"
                     : uses_mips(settings) ? "use --integrator path, or --max-depth 1 --mips off for direct light"
                                           : "use --integrator path, or --max-depth 1 for direct light");
  if (request.strict && settings.textures == kTexturesHardware)
    throw UsageError("--textures hardware", "is biased, which --strict refuses", "leave it out");
  const bool splits = request.mergeable || !request.state.file.empty() || !request.devices.empty();
  const auto refuse_history = [](const char* flag) {
    throw UsageError(flag, "makes every sample depend on those before, and no file keeps that history",
                     "leave it out, or --checkpoint, --samples, --mergeable and --devices");
  };
  if (splits && settings.denoise != kDenoiseOff && !denoises_film(settings)) refuse_history("--denoise");
  if (splits && settings.antialias == kAntialiasTaaName) refuse_history("--antialias taa");
  if (request.strict && denoises_film(settings))
    throw UsageError("--denoise", "is biased, which --strict refuses", "leave out --denoise");
  if (settings.denoise != kDenoiseOidn) return;
  if (!denoises_film(settings))
    throw UsageError("--denoise oidn", fmt::format("filters no frames, of which --integrator {} is made", kind.name),
                     "use --denoise alone, or --integrator path");
  require_oidn();
}

void settle_strict(RenderRequest& request) {
  if (!request.strict) return;
  if (is_given(request, "techniques") && request.settings.techniques & gpu::kTechniqueMerge)
    throw UsageError("--strict", "refuses merging, which blurs", "leave merge out of --techniques");
  request.settings.techniques &= ~gpu::kTechniqueMerge;
}

bool stands_alone(const RenderRequest& request) { return !request.mergeable && request.devices.empty(); }

void settle_adaptive(RenderRequest& request) {
  request.settings.tries_adaptive = stands_alone(request) && !request.pixel && may_pay_adaptive(request.settings);
}

void settle_settings(const SceneRequest& scene, RenderRequest& request) {
  settle_samples(request);
  settle_default_integrator(request);
  check_integrator(request);
  check_shutter(scene, request.settings);
  settle_strict(request);
  request.settings.tries_sky = may_try_sky(request.settings, false); // the device is not known yet
  request.settings.tries_reuse = where_to_try_reuse(request.settings, false);
  settle_adaptive(request);
}

void check_replay(const RenderRequest& request) {
  const RenderSettings& settings = request.settings;
  if (request.pixel.has_value() != request.sample.has_value())
    throw UsageError(request.pixel ? "--pixel" : "--sample", "names no path alone", "give --pixel X,Y and --sample N");
  if (!request.pixel) {
    if (request.net != 0) throw UsageError("--net", "names no path alone", "give --pixel X,Y and --sample N as well");
    return;
  }
  if (settings.guide)
    throw UsageError("--pixel", "replays paths without a guiding field, which are others", "leave out --guide");
  if (request.pixel->x >= settings.width || request.pixel->y >= settings.height)
    throw UsageError(
        "--pixel",
        fmt::format("{},{} is outside the picture of {}x{}", request.pixel->x, request.pixel->y, settings.width,
                    settings.height),
        fmt::format("stay within {},{}, or give the --size of the render", settings.width - 1, settings.height - 1));
  // Noisy pixels of an adaptive render have more samples than --spp.
  const bool may_have_more = settings.adaptive == kAdaptiveOn || may_pay_adaptive(settings);
  const std::uint64_t end = std::uint64_t{settings.last_sample} * (may_have_more ? kHighestFactor : 1);
  if (*request.sample < settings.first_sample || *request.sample >= end)
    throw UsageError("--sample", fmt::format("{} is not in {}:{}", *request.sample, settings.first_sample, end),
                     "give the --spp or --samples of the render");
}

} // namespace wavepath
