// A picture with its channels and everything that was measured.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <wavepath/export.h>
#include <wavepath/settings.h>

namespace wavepath_v0 {

enum class Stop { samples, time, target_error, interrupted, device_lost };

struct ResultState;

// Copies share the picture, which never changes. It outlives the session that made it.
class WAVEPATH_API Result {
public:
  explicit Result(std::shared_ptr<const ResultState> state) : state_(std::move(state)) {}

  std::uint32_t width() const;
  std::uint32_t height() const;
  // Of the whole picture that it is a part of (--crop): the left top corner, and the size.
  struct Place {
    std::uint32_t left = 0, top = 0, whole_width = 0, whole_height = 0;
  };
  Place place() const;
  std::uint32_t spp() const; // samples of each pixel
  double seconds() const;    // of rendering
  double error() const;      // estimated relative RMS error; not a number if there are too few samples
  Stop stop() const;         // why the render ended

  // Names as in an EXR: "R", "G", "B", "A", "albedo.R", "N.X", "Z", ...
  std::vector<std::string> channels() const;
  bool has_channel(const std::string& name) const;
  // Channels of an AOV by its name in --aov: "normal" gives "N.X", "N.Y", "N.Z". Empty if the picture lacks it.
  std::vector<std::string> channels_of(const std::string& aov) const;
  // Writes width * height values of each channel, the channels of a pixel beside each other, the top row first. `out`
  // has room for width * height * channels.size() values. Throws Error for unknown names.
  void copy(const std::vector<std::string>& channels, float* out) const;
  // The same, rounded to whole numbers, for ids.
  void copy(const std::vector<std::string>& channels, std::int32_t* out) const;

  const std::string& stats() const;                 // the stats document (--stats), as JSON
  const std::vector<std::string>& warnings() const; // one of each kind
  const std::string& repeat() const;                // command that renders the same bits; empty if there is none
  // Texts that explain channels: "wavepath.nodes" is a JSON object from ids to nodes. Empty if there is none.
  std::string text(const std::string& name) const;

  // Writes .exr, .hdr, .png or .jpg, as `render -o FILE` does. `settings`: exposure, tonemap, half, layers,
  // compression, multi-part, bits. Throws Error.
  void save(const std::string& file, const Settings& settings = {}) const;
  // The content of such a file. `format`: "png" or "jpg".
  std::vector<std::uint8_t> encode(const std::string& format, const Settings& settings = {}) const;

  const std::shared_ptr<const ResultState>& state() const { return state_; }

private:
  std::shared_ptr<const ResultState> state_;
};

// Reads a picture file with all its channels: .exr, .hdr, .png, .jpg and the other formats of `wavepath compare`.
// Values are linear. Throws Error.
WAVEPATH_API Result read(const std::string& file);

} // namespace wavepath_v0
