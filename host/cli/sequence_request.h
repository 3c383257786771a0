// What `wavepath render` is asked for of a sequence: which frames, at which moments, by which names.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace wavepath {

inline constexpr double kUsualFps = 24.0;

struct FrameRange {
  std::uint32_t first = 0, end = 1, step = 1; // first, first + step, ... below end

  std::size_t count() const { return (end - first + step - 1) / step; }
};

struct SequenceRequest {
  std::optional<FrameRange> frames; // empty = one picture
  std::optional<double> fps;        // empty = kUsualFps
  std::optional<double> turntable;  // degrees by which the camera has gone about the scene at the end of `frames`
  bool overwrites = false;          // else frames that are there are left alone
  std::optional<bool> seed_per_frame;
};

void add_sequence_flags(CLI::App& app, SequenceRequest& request);

// Refuses flags that mean nothing without frames, and frames in which nothing moves. `animation`: as the command line
// has it; empty = none. Throws UsageError.
void check_sequence(const SequenceRequest& request, const std::string& animation);

// Seconds from the first frame, number 0.
double seconds_of(const SequenceRequest& request, double frame);

// Degrees by which the camera has gone about the scene; 0 without a turntable.
double turned_by(const SequenceRequest& request, double frame);

// Seed of a frame of a sequence with this --seed; no two frames have the same. Below 2^31, as --seed.
std::uint32_t seed_of(const SequenceRequest& request, std::uint32_t seed, std::uint32_t frame);

// Whether a name holds a place for the number: %d, %04d, or a run of #.
bool has_number(std::string_view name);
// The name with the number in every such place, with leading zeros up to its width.
std::string numbered(std::string_view name, std::uint32_t frame);

} // namespace wavepath
