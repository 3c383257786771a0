// The flags of the render: its settings, when to stop, which files to write.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/cli/flags.h"
#include "host/picture/files/picture_io.h"
#include "host/render/settings/setting.h"
#include "host/session/requests.h"

namespace wavepath {

struct OutputRequest {
  std::vector<std::string> pictures; // .exr .hdr .png .jpg
  WriteOptions write;
  std::string stats, reference; // paths of files; empty = none
  std::string tev;              // HOST[:PORT] of a viewer; empty = none
  double save_every = 0.0;      // seconds between pictures and stats of the render so far; 0 = at its end alone
  bool quiet = false, verbose = false, json = false;
};

// Prepares the words of a command line for the parser. The parser would take the word after a flag for its value even
// where the value is optional. So the implied value of such a flag is inserted.
std::vector<std::string> spelled_out(std::vector<std::string> words);

// Help of a setting where a command differs from the table of settings.
struct HelpOverride {
  std::string_view name;         // of the setting
  const char* meaning = nullptr; // null = as in the table
  const char* initial = nullptr;
  std::uint32_t highest = 0; // upper limit of a whole number, where it is less than in the table; 0 = as there
};

// Adds the flags of those settings of a group that the command offers. `heading`: replaces the group's own heading. The
// requests must outlive the parsing of `app`, here and below.
void add_settings(CLI::App& app, Offer command, SettingGroup group, RenderRequest& request,
                  std::span<const HelpOverride> help_overrides = {}, const char* heading = nullptr);

// Adds all settings of `render`, for a command that describes a render without making it (`info`).
void add_settings_of_render(CLI::App& app, RenderRequest& request);

// Groups of settings, each together with the flags of the same subject that are no settings:
void add_picture_flags(CLI::App& app, Offer command, RenderRequest& request);
void add_transport_flags(CLI::App& app, Offer command, RenderRequest& request);
// --time-limit, --target-error and others; `render` alone offers them.
void add_stop_flags(CLI::App& app, RenderRequest& request);

void add_bvh_flag(CLI::App& app, RenderRequest& request);
void add_device_flag(CLI::App& app, RenderRequest& request, const char* heading = nullptr);
void add_devices_flag(CLI::App& app, RenderRequest& request);
void add_plan_flags(CLI::App& app, RenderRequest& request);
void add_replay_flags(CLI::App& app, RenderRequest& request);
void add_output_flags(CLI::App& app, OutputRequest& request);
// Adds the flags that name picture files and say how to write them. `initial`: the file that is written if none is
// named, for the help. `hides`: only --help-all shows the rarer ones.
void add_picture_output_flags(CLI::App& app, OutputRequest& request, const char* initial, bool hides);
// Adds the flags that say how EXR files are laid out, and how many bits a PNG has. `hides`: as above.
void add_layout_flags(CLI::App& app, const char* group, WriteOptions& options, bool hides);
// The flags that give these options where all files that a command writes have one of these formats, each preceded by a
// blank: those of EXR files if there is one, --bits where there are none but PNG.
std::string layout_flags(const WriteOptions& options, std::span<const std::string> pictures);
// Throws UsageError for options that no named file could show.
void check_write_options(const OutputRequest& request);
void add_tone_flags(CLI::App& app, WriteOptions& options);

} // namespace wavepath
