// The rows of the table of settings: values and meaning of what can be set about shadows.
#include <span>
#include <vector>

#include <fmt/format.h>

#include "host/base/hash.h"
#include "host/base/read_file.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/render/settings/shadow_settings.h"

namespace wavepath {
namespace {

using S = RenderSettings;

constexpr std::uint32_t kSmallestMap = 16, kLargestMap = 16384, kMostTaps = 1024, kMostCascades = 8;
constexpr double kMostShadowBias = 1e6, kMostBlur = 256.0, kMostExponent = 88.0; // exp(88) is the last that floats hold

void read_shadow_bias(const FlagValue& value, S& settings) {
  const std::size_t colon = value.text.find(':');
  settings.shadow_bias = FlagValue{value.flag, value.text.substr(0, colon)}.choice(kShadowBiasNames);
  settings.shadow_bias_amount.reset();
  if (colon != std::string::npos)
    settings.shadow_bias_amount = FlagValue{value.flag, value.text.substr(colon + 1)}.number(0.0, kMostShadowBias);
}

std::string shadow_bias_text(const S& settings) {
  const std::string kind(kShadowBiasNames[settings.shadow_bias]);
  return settings.shadow_bias_amount ? fmt::format("{}:{}", kind, *settings.shadow_bias_amount) : kind;
}

void read_shadow_cookie(const FlagValue& value, S& settings) { settings.shadow_cookie = value.text; }

// Identity by the contents of the file: another picture of the same name is another render. A file that cannot be read
// is refused later.
std::string shadow_cookie_identity(const S& settings) {
  std::vector<std::uint8_t> bytes(regular_file_size(settings.shadow_cookie).value_or(0));
  if (settings.shadow_cookie.empty() || !read_file(settings.shadow_cookie, 0, bytes)) return settings.shadow_cookie;
  Hash hash;
  hash.add_all(bytes);
  return fmt::format("{:016x}", hash.value());
}

void read_shadow_bits(const FlagValue& value, S& settings) {
  settings.shadow_bits = value.whole_number(16, 32);
  if (settings.shadow_bits != 16 && settings.shadow_bits != 32) value.refuse("is no such format", "give 16 or 32");
}

} // namespace

std::vector<Setting> shadow_rows() {
  static const std::vector<std::string_view> names = kShadowTechniques.names();
  return {
      {.name = "shadows",
       .value = ChoiceValue{&S::shadows, names},
       .meaning = fmt::format("technique for the shadows of direct light. traced: shadow rays. The others are "
                              "techniques of real-time rendering: {}",
                              fmt::join(std::span(names).subspan(1), ", ")),
       .placeholder = "NAME",
       .label = "shadows",
       .study = names},
      {.name = "shadow-size",
       .value = WholeValue{&S::shadow_size, kSmallestMap, kLargestMap},
       .meaning = "side of a shadow map in texels. The default is reduced if the maps do not fit into memory",
       .placeholder = "N",
       .label = "map size",
       .study = {"256", "512", "1024", "2048", "4096"}},
      {.name = "shadow-bias",
       .value = SpecialValue{read_shadow_bias, shadow_bias_text},
       .meaning = fmt::format("offset that keeps surfaces from shadowing themselves: {}. AMOUNT in widths of a texel",
                              fmt::join(kShadowBiasNames, ", ")),
       .placeholder = "KIND[:AMOUNT]",
       .study = {"constant", "slope", "normal", "plane", "cone"}},
      {.name = "shadow-taps",
       .value = WholeValue{&S::shadow_taps, 1, kMostTaps},
       .meaning = "number of points of a shadow map that a filter reads",
       .placeholder = "N",
       .label = "taps",
       .study = {"4", "16", "64"}},
      {.name = "shadow-pattern",
       .value = ChoiceValue{&S::shadow_pattern, kShadowPatternNames},
       .meaning = "arrangement of the points of --shadow-taps. rotated (Poisson) and vogel turn it from pixel to pixel",
       .label = "pattern",
       .study = {"grid", "poisson", "rotated", "vogel"}},
      {.name = "shadow-blur",
       .value = NumberValue{&S::shadow_blur, 0.0, kMostBlur},
       .meaning = "radius in texels of a filter of fixed size",
       .placeholder = "TEXELS",
       .study = {"0", "1", "2", "4"}},
      {.name = "shadow-cascades",
       .value = WholeValue{&S::shadow_cascades, 1, kMostCascades},
       .meaning = "number of shadow maps of a sun, each for a range of depths",
       .placeholder = "N",
       .label = "cascades",
       .study = {"1", "2", "4", "8"}},
      {.name = "shadow-exponent",
       .value = OptionalNumberValue{&S::shadow_exponent, 1.0, kMostExponent},
       .meaning = "exponent of exponential shadow maps. lispsm: distance of its eye, in extents of the view",
       .placeholder = "C",
       .initial = "the technique's own",
       .study = {"20", "40", "80"}},
      {.name = "shadow-bits",
       .value = SpecialValue{read_shadow_bits, [](const S& s) { return fmt::format("{}", s.shadow_bits); }},
       .meaning = "bits of each moment in a shadow map: 16 or 32",
       .placeholder = "N",
       .initial = "32",
       .study = {"16", "32"}},
      {.name = "shadow-source",
       .value = ChoiceValue{&S::shadow_source, kShadowSourceNames},
       .meaning = "method to make shadow maps: rasterization, or rays",
       .study = {"raster", "traced"}},
      {.name = "shadow-cookie",
       .value = SpecialValue{read_shadow_cookie, [](const S& s) { return s.shadow_cookie; }},
       .meaning = "picture that every spot light and sun shines through: EXR or HDR linear, PNG or JPG sRGB",
       .placeholder = "FILE",
       .initial = "none",
       .identity = shadow_cookie_identity},
      {.name = "shadow-ambient",
       .value = NumberValue{&S::shadow_ambient, 0.0, 1.0},
       .meaning = "fraction of a light that reaches surfaces in its shadow",
       .placeholder = "FRACTION",
       .label = "light in shadow"},
  };
}

} // namespace wavepath
