// The module that reads and writes pictures by OpenImageIO: what it offers, and how it is loaded. It is a shared object
// of its own, because OpenImageIO brings some 250 libraries along, which take longer to load than a small scene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wavepath {

enum class Encoding : std::uint8_t { linear, srgb, gamma };

// One picture of a file, as its header tells of it.
struct StoredPart {
  std::uint32_t width = 0, height = 0;           // size of the data window, the stored pixels
  std::int64_t x = 0, y = 0;                     // its upper left corner, from that of the display window
  std::uint32_t full_width = 0, full_height = 0; // size of the display window
  std::vector<std::string> channels;
  std::optional<std::size_t> unassociated_alpha; // the channel that colours are not yet multiplied by
  Encoding encoding = Encoding::linear;
  double gamma = 1.0;                                 // for Encoding::gamma: linear = stored ^ gamma
  std::optional<std::array<float, 8>> chromaticities; // x and y of red, green, blue and white
  int orientation = 1;                                // as in EXIF: 1 is upright
  bool display = false;                               // 8 or 16 bits for a display
  bool deep = false, cube = false;
};

struct StoredChoice {
  std::size_t part = 0;
  std::vector<std::size_t> channels;
};

// Says what to read; throws to refuse the file before memory is taken for its pixels.
using ChooseStored = std::function<StoredChoice(const std::vector<StoredPart>&)>;

struct PictureModule {
  // Planes of width * height floats of the chosen part, rows from the top. `format` as OpenImageIO names it. Whole
  // numbers of EXR files keep their values; those of other formats become 0 to 1. Throws ImageError.
  std::vector<std::vector<float>> (*read)(const std::string& path, const char* format, std::uint64_t most_bytes,
                                          const ChooseStored& choose);
  // A Radiance file of three interleaved channels, each from 0 to below 2^127, rounded to the nearest that the
  // brightest channel of the pixel leaves. Throws ImageError.
  std::vector<std::uint8_t> (*encode_radiance)(std::uint32_t width, std::uint32_t height,
                                               const std::vector<float>& rgb);
};

inline constexpr const char* kPictureModuleFile = "libwavepath_pictures.so";
inline constexpr const char* kPictureModuleEntry = "wavepath_pictures";

// Begins to load it in a thread, unless it is loaded already.
void begin_loading_pictures();

// The module, waited for. Throws Error about `path`, the picture that needs it, if it cannot be loaded.
const PictureModule& picture_module(const std::string& path);

} // namespace wavepath
