// A setting of a render: what a row of the table of settings holds, and what can be done with any row.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "host/render/settings/flag_value.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/settings.h"

namespace wavepath {

// Kinds of values. Each names the member of RenderSettings that holds the value, and the values allowed.
struct ChoiceValue { // --NAME ONE-OF-NAMES; the member is the index
  std::uint32_t RenderSettings::*member = nullptr;
  std::span<const std::string_view> names{};
  std::string_view bare{}; // what --NAME alone stands for; empty = it needs a value
};
struct OnOffValue { // --NAME on|off
  bool RenderSettings::*member = nullptr;
};
struct SwitchValue { // --NAME
  bool RenderSettings::*member = nullptr;
};
struct WholeValue {
  std::uint32_t RenderSettings::*member = nullptr;
  std::uint32_t lowest = 0, highest = 0;
  std::uint32_t RenderSettings::*instead_of_0 = nullptr; // whose value counts while the member is 0; null = none
};
struct NumberValue {
  double RenderSettings::*member = nullptr;
  double lowest = 0.0, highest = 0.0;
  double Lens::*of_lens = nullptr; // in place of `member`, of RenderSettings::lens
  double& in(RenderSettings& settings) const { return of_lens ? settings.lens.*of_lens : settings.*member; }
  double in(const RenderSettings& settings) const { return of_lens ? settings.lens.*of_lens : settings.*member; }
};
struct PositiveValue { // 0 = not set
  double RenderSettings::*member = nullptr;
};
struct OptionalNumberValue {
  std::optional<double> RenderSettings::*member = nullptr;
  double lowest = 0.0, highest = 0.0;
};
struct RadianceValue { // --NAME R,G,B
  std::optional<glm::vec3> RenderSettings::*member = nullptr;
  double highest = 0.0;
};
struct IntegratorValue {}; // RenderSettings::integrator, by its name
struct SpecialValue {      // several members, or text of a form of its own
  void (*read)(const FlagValue& value, RenderSettings& settings) = nullptr;
  std::string (*text)(const RenderSettings& settings) = nullptr; // empty = not set
};
using SettingValue = std::variant<ChoiceValue, OnOffValue, SwitchValue, WholeValue, NumberValue, PositiveValue,
                                  OptionalNumberValue, RadianceValue, IntegratorValue, SpecialValue>;

// Headings of --help. From `hybrid` to `transparency` they hold the techniques of the hybrid integrator.
enum class SettingGroup {
  picture,
  lens,
  stop,
  parts,
  transport,
  speed,
  decisions,
  hybrid,
  shadows,
  occlusion,
  shading,
  transparency,
  others
};

// The integrators that support a setting: all, or those whose IntegratorKind::settings lists its name. The others
// refuse it where it would change what the picture shows, and ignore it where it would change the noise alone.
enum class SupportedBy { all, listed_else_refused, listed_else_ignored };

// What a setting decides: nothing that is kept (speed, end of the render), which channels there are, or the values of
// the picture. Channels and values belong to the identity, values to the command that repeats a picture.
enum class Decides { nothing, channels, picture };

// Which commands offer a setting as a flag; bits.
enum Offer : unsigned { kByRender = 1, kByView = 2, kByStudy = 4, kByBench = 8 };

struct Setting {
  std::string_view name{}; // of the flag, without "--"; also its key in identity and stats
  SettingValue value{};
  std::string meaning{};     // for --help: a clause, with the unit
  std::string placeholder{}; // of the value in --help; choices list themselves instead
  std::string initial{};     // the default in words, where its value does not say it
  SettingGroup group = SettingGroup::transport;
  bool advanced = false; // for experts: --help leaves it out, --help-all shows it
  SupportedBy supported_by = SupportedBy::all;
  Decides decides = Decides::picture;
  unsigned offered = 0;
  bool always_copied = false;            // tell it in copied commands even where it is the default
  const char* label = nullptr;           // in the panel of the window; null = not there
  std::vector<std::string_view> study{}; // values along its axis of a study, the naive one first; empty = no axis
  // What the identity tells instead of the value; an empty text is left out. Null = the value.
  std::string (*identity)(const RenderSettings& settings) = nullptr;
};

// Reads the text of a value into the settings; throws UsageError.
void read_setting(const Setting& setting, const std::string& text, RenderSettings& settings);
// The value as read_setting() takes it, numbers in the shortest decimals that give the same bits; empty = not set.
std::string text_of(const Setting& setting, const RenderSettings& settings);
// The flag with the value: "--max-depth 4", "--denoise"; empty if it is not set.
std::string flag_text(const Setting& setting, const RenderSettings& settings);
bool is_default(const Setting& setting, const RenderSettings& settings);

// Values of a named choice; empty for other kinds.
std::vector<std::string_view> choices_of(const Setting& setting);
std::uint32_t number_of(const WholeValue& value, const RenderSettings& settings);

bool is_supported(const Setting& setting, const IntegratorKind& kind);
// "hybrid or ao": the integrators that list a setting, or that know an AOV besides those of all.
std::string supporters_text(std::string_view setting);
std::string aov_supporters_text(std::string_view aov);

} // namespace wavepath
