// Shows a film in a window: develops, scales and encodes it on the device, into a buffer that the window copies to its
// image.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/gpu/kernel.h"
#include "host/picture/tonemap.h"
#include "host/render/progressive/progressive.h"
#include "kernels/display/display_types.h"

namespace wavepath {

// Quantity that is shown. `error`: relative standard error of each pixel, in false colour up to DisplayOptions::range.
// `shadow_error`: false shadows (shadow_comparison.h), computed on the host; the colour is shown until it is ready.
enum class Shown : std::uint32_t {
  color,
  albedo,
  normal,
  depth,
  position,
  direct,
  indirect,
  emission,
  samples,
  variance,
  error,
  shadow_error,
  ao,
  roughness,
  metallic,
  triangles,
  instances,
  materials
};
inline constexpr std::array<std::string_view, 18> kShownNames = {
    "color",    "albedo", "normal",       "depth", "position",  "direct",   "indirect",  "emission",  "samples",
    "variance", "error",  "shadow-error", "ao",    "roughness", "metallic", "triangles", "instances", "materials"};

// Values of --aov that the render needs for this quantity, to be put into RenderPlan::aovs.
std::vector<std::string> aovs_for(Shown shown);
// False if the frames of the integrator do not hold the quantity.
bool can_show(const IntegratorKind& integrator, Shown shown);

struct DisplayOptions {
  Shown shown = Shown::color;
  double exposure = 0.0;      // stops; for colour, direct, indirect, emission
  bool auto_exposure = false; // the window chooses the exposure from the picture
  Tonemap tonemap = Tonemap::neutral;
  bool bgra = false; // order of the bytes in a word: B first, else R first; A is 255
  double range =
      // Value that is shown brightest, for depth (metres), position (metres), samples, error, variance; 0 = automatic.
      0.0;
  bool coarse = false;            // drawn at the size of the film, which is smaller while the camera moves
  std::vector<float> group_gains; // of groups of lights, for colour; empty = all 1

  bool mixes() const {
    return std::ranges::any_of(group_gains, [](float gain) { return gain != 1.0f; });
  }
};

class Display {
public:
  // Compiles its kernel.
  explicit Display(Device& device);

  // Draws the picture so far. Pixels without a sample keep what was drawn before, so that nothing turns black when the
  // render starts over. Pixels left of `first_column` keep it, too. Shows the colour if `shown` needs AOVs that are not
  // rendered.
  void draw(const Progressive& progressive, const DisplayOptions& options, std::uint32_t first_column = 0);
  // Shows a picture on the screen size drawn last: values of 0 to 1 in linear sRGB, R G B first.
  void show(const Picture& picture, bool bgra);

  // The encoded pixels: sRGB, one word a pixel, row-major from the top left, width() * height() words, the full size of
  // the render unless it was drawn coarse. Valid until the next draw(), which may replace the buffer if the size has
  // changed.
  const Buffer& pixels() const { return pixels_; }
  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }

private:
  void draw_band(const FilmBand& band, gpu::DisplayJob job);
  void resize(std::uint32_t width, std::uint32_t height);

  Device& device_;
  std::optional<Kernel> kernel_;
  Buffer pixels_;
  std::uint32_t width_ = 0, height_ = 0;
};

} // namespace wavepath
