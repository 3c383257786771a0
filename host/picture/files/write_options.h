// How a picture is written to a file: names of channels, compression, depth, tone.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "host/picture/tonemap.h"

namespace wavepath {

// Names of the channels of an EXR: those that docs/cameras_and_passes.md lists, or those of Blender's passes.
enum class LayerNames : std::uint8_t { plain, blender };
inline constexpr std::string_view kLayerNames[] = {"plain", "blender"};

// Of an EXR. All but dwaa are lossless.
enum class Compression : std::uint8_t { zip, zips, piz, dwaa, none };
inline constexpr std::string_view kCompressionNames[] = {"zip", "zips", "piz", "dwaa", "none"};

struct WriteOptions {
  bool half = false;                    // EXR: 16-bit floats
  std::optional<double> exposure = 0.0; // PNG, JPG: radiance is scaled by 2^exposure; empty = auto_exposure()
  Tonemap tonemap = Tonemap::neutral;
  std::uint32_t bits = 8;                // PNG: of each channel, 8 or 16
  LayerNames layers = LayerNames::plain; // EXR
  Compression compression = Compression::zip;
  bool multi_part = false; // EXR: each layer in a part of its own
};

} // namespace wavepath
