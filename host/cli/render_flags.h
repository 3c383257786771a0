// The flags of the render: its settings, when to stop, which files to write.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bvh/build.h"
#include "host/cli/flags.h"
#include "host/picture/files/picture_io.h"
#include "host/render/render.h"
#include "host/render/settings/setting.h"

namespace wavepath {

inline constexpr std::uint32_t kOpenEndedSamples = 65536; // where time, error or the user ends the render

struct OutputRequest {
  std::vector<std::string> pictures; // .exr .hdr .png .jpg
  WriteOptions write;
  std::string stats, reference; // files; empty = none
  std::string tev;              // HOST[:PORT] of a viewer; empty = none
  bool quiet = false, verbose = false, json = false;
};

// The state of a render on disk, to go on from.
struct StateRequest {
  std::string file;       // empty = none
  double interval = 30.0; // seconds between saves
  bool resume = false;
};

struct RenderRequest {
  RenderPlan settings;                 // its sample range is complete after resolve_samples() (resolve.h)
  std::vector<std::string_view> given; // names of the settings that the command line has
  std::optional<bvh::Quality> bvh;     // empty = chosen from the number of rays
  std::string device;
  std::string devices;                    // as --devices has it; empty = one
  std::vector<std::string> other_devices; // that it means, beside `device`
  std::optional<glm::dvec3> origin;       // empty = the eye
  bool strict = false;
  bool mergeable = false; // .exr outputs hold the exact sums
  StateRequest state;
  std::string plan_file;                         // of an earlier render, whose decisions are taken over; empty = none
  std::optional<std::uint64_t> training_paths;   // empty = by the length of the render
  std::optional<std::uint32_t> guide_iterations; // likewise
  std::optional<glm::uvec2> pixel;               // replay this one's
  std::optional<std::uint32_t> sample;           // instead of rendering
  std::uint32_t replicate = 0;                   // of the pixel
};

// The words of a command line for the parser. A flag that may stand without its value would take the word behind it,
// whatever that is: the value that it stands for then is spelled out.
std::vector<std::string> spelled_out(std::vector<std::string> words);

bool is_given(const RenderRequest& request, std::string_view setting);

// What a command says otherwise about a setting than the table does.
struct HelpOverride {
  std::string_view name;         // of the setting
  const char* meaning = nullptr; // null = as in the table
  const char* initial = nullptr;
  std::uint32_t highest = 0; // of a whole number, where less than in the table; 0 = as there
};

// The requests must outlive the parsing of `app`. The flags of all settings of a group that the command offers; with
// `heading`, under that one instead of the group's own.
void add_settings(CLI::App& app, Offer command, SettingGroup group, RenderRequest& request,
                  std::span<const HelpOverride> help_overrides = {}, const char* heading = nullptr);

// All settings of `render`, for a command that tells of a render without making it.
void add_settings_of_render(CLI::App& app, RenderRequest& request);

// Groups of settings, each with the flags of its subject that are no settings of a render:
void add_picture_flags(CLI::App& app, Offer command, RenderRequest& request);
void add_transport_flags(CLI::App& app, Offer command, RenderRequest& request);
void add_stop_flags(CLI::App& app, RenderRequest& request); // of `render`

void add_bvh_flag(CLI::App& app, RenderRequest& request);
void add_device_flag(CLI::App& app, RenderRequest& request, const char* heading = nullptr);
void add_devices_flag(CLI::App& app, RenderRequest& request);
void add_plan_flags(CLI::App& app, RenderRequest& request);
void add_replay_flags(CLI::App& app, RenderRequest& request);
void add_output_flags(CLI::App& app, OutputRequest& request);
// Which files, and how they are written. `initial`: what is written if none is named, for the help.
void add_picture_output_flags(CLI::App& app, OutputRequest& request, const char* initial);
void add_tone_flags(CLI::App& app, WriteOptions& options);

} // namespace wavepath
