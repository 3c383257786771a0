// The flags that say how to render and where the result goes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bvh/build.h"
#include "host/cli/flags.h"
#include "host/film/picture_io.h"
#include "host/render/render.h"

namespace wavepath {

struct OutputRequest {
  std::vector<std::string> pictures; // .exr .hdr .png .jpg
  WriteOptions write;
  std::string stats, reference; // files; empty = none
  bool quiet = false, verbose = false, json = false;
};

// The state of a render on disk, to go on from.
struct StateRequest {
  std::string file;       // empty = none
  double interval = 30.0; // seconds between saves
  bool resume = false;
};

struct RenderRequest {
  RenderSettings settings; // its sample range is set by settle_samples()
  std::optional<std::uint32_t> spp;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> samples; // first, one past the last
  std::optional<std::uint32_t> filter;
  std::optional<bvh::Quality> bvh; // empty = chosen from the number of rays
  std::string device;
  std::optional<glm::dvec3> origin; // empty = the eye
  bool strict = false;
  bool mergeable = false; // .exr outputs hold the exact sums
  StateRequest state;
  std::optional<glm::uvec2> pixel;     // replay this one's
  std::optional<std::uint32_t> sample; // instead of rendering
};

// The requests must outlive the parsing of `app`. What a render needs to know, and whoever measures one as well:
void add_render_flags(CLI::App& app, RenderRequest& request);
// Which integrator, and what the hybrid ones need to know:
void add_hybrid_flags(CLI::App& app, RenderRequest& request);
// When it ends and which picture it makes:
void add_stop_flags(CLI::App& app, RenderRequest& request);
void add_picture_flags(CLI::App& app, RenderRequest& request);
// Which path to replay:
void add_replay_flags(CLI::App& app, RenderRequest& request);
void add_output_flags(CLI::App& app, OutputRequest& request);
// Which files, and how they are written. `initial`: what is written if none is named, for the help.
void add_picture_output_flags(CLI::App& app, OutputRequest& request, const char* initial);
void add_tone_flags(CLI::App& app, WriteOptions& options);

void read_size(const FlagValue& value, RenderSettings& settings); // WIDTHxHEIGHT

// Works out the sample range once all flags are known. Throws UsageError where --spp and --samples disagree.
void settle_samples(RenderRequest& request);

// To be called after it. Throws UsageError where the integrator cannot do what else is asked for.
void check_integrator(const RenderRequest& request);

// To be called after it. Throws UsageError where a path is to be replayed that the render does not have.
void check_replay(const RenderRequest& request);

} // namespace wavepath
