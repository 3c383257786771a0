// A setting of a render: the row of the table of settings, and operations that work on any row.
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

// Kinds of values. Each kind names the member of RenderSettings that holds the value, and the allowed range.
struct ChoiceValue { // --NAME ONE-OF-NAMES; the member holds the index
  std::uint32_t RenderSettings::*member = nullptr;
  std::span<const std::string_view> names{};
  std::string_view bare{}; // value that --NAME alone stands for; empty = a value is required
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
  std::uint32_t RenderSettings::*instead_of_0 = nullptr; // member whose value is used while `member` is 0; null = none
};
struct NumberValue {
  double RenderSettings::*member = nullptr;
  double lowest = 0.0, highest = 0.0;
  double Lens::*of_lens = nullptr; // member of RenderSettings::lens that is used in place of `member`; null = none
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
struct IntegratorValue {}; // name of RenderSettings::integrator, or auto
struct SpecialValue {      // several members, or text with its own syntax
  void (*read)(const FlagValue& value, RenderSettings& settings) = nullptr;
  std::string (*text)(const RenderSettings& settings) = nullptr; // empty = not set
};
using SettingValue = std::variant<ChoiceValue, OnOffValue, SwitchValue, WholeValue, NumberValue, PositiveValue,
                                  OptionalNumberValue, RadianceValue, IntegratorValue, SpecialValue>;

// Headings of --help. Groups `hybrid` to `transparency` are techniques of the hybrid integrator.
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
  reflections,
  shading,
  transparency,
  others
};

// Integrators that support a setting: all of them, or those whose IntegratorKind::settings lists its name. The others
// refuse a setting that would change the picture's mean, and ignore one that would change only its noise.
enum class SupportedBy { all, listed_else_refused, listed_else_ignored };

// Part of the result that a setting decides: nothing in the file (speed, end of the render); which channels exist;
// their values. The identity holds `channels` and `picture`; a command that repeats a picture holds `picture`.
enum class Decides { nothing, channels, picture };

// Commands that offer a setting as a flag; bits.
enum Offer : unsigned { kByRender = 1, kByView = 2, kByStudy = 4, kByBench = 8 };

struct Setting {
  std::string_view name{}; // name of the flag without "--"; also its key in identity and stats
  SettingValue value{};
  std::string meaning{};     // text for --help: one clause, with the unit
  std::string placeholder{}; // word for the value in --help; unused for choices, which are listed
  std::string initial{};     // the default in words, where the value does not say it
  SettingGroup group = SettingGroup::transport;
  bool advanced = false; // shown by --help-all only
  SupportedBy supported_by = SupportedBy::all;
  std::string_view listed_as{}; // in IntegratorKind::settings, with others; empty = under its own name
  Decides decides = Decides::picture;
  unsigned offered = 0;
  bool always_copied = false;            // written in copied commands even at its default
  const char* label = nullptr;           // text in the window's panel; null = not shown
  bool planned = false;                  // it may be decided, by itself or with another setting: a plan records it
  std::string_view unplanned{};          // value of its auto where no pilot decides; empty = it has no such auto
  std::vector<std::string_view> study{}; // values of its axis in a study, the naive one first; empty = no axis
  // Text in the identity in place of the value; an empty result is left out. Null = the value itself.
  std::string (*identity)(const RenderSettings& settings) = nullptr;
};

// Values of --integrator, in the order of --help.
std::vector<IntegratorSetting> integrator_values();
std::string_view name_of(const IntegratorSetting& integrator);

// Parses `text` and sets the member. Throws UsageError.
void read_setting(const Setting& setting, const std::string& text, RenderSettings& settings);
// The value in the syntax of read_setting(), numbers with the fewest decimals that give the same bits; empty = not set.
std::string text_of(const Setting& setting, const RenderSettings& settings);
// The flag with the value, as a shell takes it: "--max-depth 4", "--denoise"; empty if it is not set.
std::string flag_text(const Setting& setting, const RenderSettings& settings);
bool is_default(const Setting& setting, const RenderSettings& settings);

// Names of the values of a choice; empty for other kinds.
std::vector<std::string_view> choices_of(const Setting& setting);
std::uint32_t number_of(const WholeValue& value, const RenderSettings& settings);

bool is_supported(const Setting& setting, const IntegratorKind& kind);
bool is_supported(const Setting& setting, const RenderSettings& settings); // by the integrator that was given
// True if its value is left to be decided.
bool is_auto(const Setting& setting, const RenderSettings& settings);
// Values of --integrator that support a setting or an AOV, as "hybrid or ao"; empty for an AOV that all support.
std::string supporters_text(std::string_view setting);
std::string aov_supporters_text(std::string_view aov);

} // namespace wavepath
