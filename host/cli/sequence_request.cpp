// Flags of a sequence, and what follows from them for a frame.
#include "host/cli/sequence_request.h"

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/cli/flags.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kLastFrame = 9'999'999;
constexpr const char* kFramesRemedy = "write it as A:B or A:B:STEP, such as 0:24, which is frames 0 to 23";

FrameRange read_frames(const FlagValue& value) {
  FrameRange range;
  auto [first, rest] = value.split(':', kFramesRemedy);
  if (rest.text.find(':') != std::string::npos) {
    const auto [end, step] = rest.split(':', kFramesRemedy);
    rest = end;
    range.step = step.whole_number(1, kLastFrame);
  }
  range.first = first.whole_number(0, kLastFrame);
  range.end = rest.whole_number(0, kLastFrame);
  if (range.end <= range.first) value.refuse("holds no frame", kFramesRemedy);
  return range;
}

// Where a place for the number begins and ends, and its width; nothing if there is none from `from` on.
struct NumberPlace {
  std::size_t begin = 0, end = 0, width = 0;
};
std::optional<NumberPlace> find_place(std::string_view name, std::size_t from) {
  for (std::size_t i = from; i < name.size(); ++i) {
    if (name[i] == '#') {
      std::size_t end = i;
      while (end < name.size() && name[end] == '#') ++end;
      return NumberPlace{i, end, end - i};
    }
    if (name[i] != '%') continue;
    std::size_t end = i + 1, width = 0;
    for (; end < name.size() && name[end] >= '0' && name[end] <= '9' && end < i + 4; ++end)
      width = 10 * width + static_cast<std::size_t>(name[end] - '0');
    if (end < name.size() && name[end] == 'd' && (end == i + 1 || name[i + 1] == '0'))
      return NumberPlace{i, end + 1, width};
  }
  return std::nullopt;
}

constexpr std::uint32_t kSeedBits = 0x7fffffffu; // of --seed

// A bijection of the seeds in which every bit of the argument changes about half of those of the result (the finalizer
// of MurmurHash3, modulo 2^31: odd factors and shifted exclusive ors are invertible there, too).
std::uint32_t mix(std::uint32_t x) {
  x &= kSeedBits;
  x = ((x ^ x >> 16) * 0x85ebca6bu) & kSeedBits;
  x = ((x ^ x >> 13) * 0xc2b2ae35u) & kSeedBits;
  return x ^ x >> 16;
}

} // namespace

void add_sequence_flags(CLI::App& app, SequenceRequest& request) {
  const char* group = "Frames of a film";
  add_flag(app, group,
           {"--frames", "A:B[:STEP]",
            "render the frames A, A + STEP, ... before B, one picture each. Names of outputs hold a place for the "
            "number: %04d or ####. Frames whose files exist are left alone, but for --overwrite. Needs --animation or "
            "--turntable",
            "one picture"},
           [&](const FlagValue& value) { request.frames = read_frames(value); });
  add_flag(app, group,
           {"--fps", "N",
            "frames per second: frame K shows the animation K / N seconds after --at. --shutter then counts from there",
            fmt::format("{}", kUsualFps)},
           [&](const FlagValue& value) { request.fps = value.positive_number(); });
  add_flag(
      app, group,
      {"--turntable", "DEGREES",
       "the camera goes about the vertical axis through the scene's middle: at frame K by DEGREES * K / B", "none"},
      [&](const FlagValue& value) { request.turntable = value.number(-1e6, 1e6); });
  add_switch(app, group, {"--overwrite", "", "render frames whose files exist again", "off", kAdvanced},
             request.overwrites);
  add_flag(app, group,
           {"--seed-per-frame", "on|off", "whether each frame has noise of its own; off: all have that of --seed", "on",
            kAdvanced},
           [&](const FlagValue& value) {
             static constexpr std::string_view kNames[] = {"off", "on"};
             request.seed_per_frame = value.choice(kNames) == 1;
           });
}

void check_sequence(const SequenceRequest& request, const std::string& animation) {
  if (!request.frames) {
    const char* given = request.fps              ? "--fps"
                        : request.turntable      ? "--turntable"
                        : request.overwrites     ? "--overwrite"
                        : request.seed_per_frame ? "--seed-per-frame"
                                                 : nullptr;
    if (given) throw UsageError(given, "means nothing for one picture", "add --frames A:B, or leave it out");
    return;
  }
  if (animation.empty() && !request.turntable)
    throw UsageError("--frames", "all frames would show the same: nothing moves", "add --animation or --turntable");
  if (animation.empty() && request.fps)
    throw UsageError("--fps", "means nothing without an animation", "add --animation, or leave it out");
}

double seconds_of(const SequenceRequest& request, double frame) { return frame / request.fps.value_or(kUsualFps); }

double turned_by(const SequenceRequest& request, double frame) {
  return request.turntable ? *request.turntable * frame / request.frames->end : 0.0;
}

std::uint32_t seed_of(const SequenceRequest& request, std::uint32_t seed, std::uint32_t frame) {
  if (!request.seed_per_frame.value_or(true)) return seed;
  return mix(frame * 0x9e3779b9u + mix(seed));
}

bool has_number(std::string_view name) { return find_place(name, 0).has_value(); }

std::string numbered(std::string_view name, std::uint32_t frame) {
  std::string text;
  std::size_t done = 0;
  while (const auto place = find_place(name, done)) {
    text += name.substr(done, place->begin - done);
    text += fmt::format("{:0{}}", frame, place->width);
    done = place->end;
  }
  return text + std::string(name.substr(done));
}

} // namespace wavepath
