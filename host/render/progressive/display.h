// The film as a window shows it: developed, scaled up and encoded on the device, into words that it copies to its
// image.
#pragma once

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

// What of the film is shown. `error`: the relative standard error of each pixel, as false colour up to
// DisplayOptions::range. `shadow_error`: where shadows are false (shadow_comparison.h), which is made on the host; the
// colour until then.
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

// The --aov that rendering needs so that it can be shown: put it into RenderPlan::aovs. Empty = none.
std::vector<std::string> aovs_for(Shown shown);
// False: its frames hold no such thing.
bool can_show(const IntegratorKind& integrator, Shown shown);

struct DisplayOptions {
  Shown shown = Shown::color;
  double exposure = 0.0;      // stops; of colour, direct, indirect, emission
  bool auto_exposure = false; // the window chooses the exposure from the picture
  Tonemap tonemap = Tonemap::neutral;
  bool bgra = false; // order of the bytes in a word: B first, else R first; A is 255
  double range =
      0.0; // depth (metres), position (metres), samples, error, variance: what is shown brightest; 0 = automatic
};

class Display {
public:
  // Compiles its kernel.
  explicit Display(Device& device);

  // Draws what there is of the picture. Pixels that have no sample yet keep what was drawn before, so that nothing goes
  // black when the render begins anew. Shows the colour where `shown` needs AOVs that are not rendered.
  // What is left of `first_column` stays too.
  void draw(const Progressive& progressive, const DisplayOptions& options, std::uint32_t first_column = 0);
  // Shows values of 0 to 1 in linear sRGB, R G B first, instead, of the size that was drawn last.
  void show(const Picture& picture, bool bgra);

  // sRGB-encoded, one word a pixel, row-major from the top left, width() * height() of them: the size that the render
  // has in full. Valid until the next draw(), which may replace the buffer when the size has changed.
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
