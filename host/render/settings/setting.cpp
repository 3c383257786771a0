#include "host/render/settings/setting.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/shell_quote.h"

namespace wavepath {
namespace {

constexpr std::string_view kOffOn[] = {"off", "on"};

std::vector<std::string_view> integrator_names() {
  std::vector<std::string_view> names;
  for (const IntegratorSetting& value : integrator_values()) names.push_back(name_of(value));
  return names;
}

// One function of each name a kind of value.

void read(const ChoiceValue& kind, const FlagValue& value, RenderSettings& settings) {
  settings.*kind.member = value.choice(kind.names);
}
void read(const OnOffValue& kind, const FlagValue& value, RenderSettings& settings) {
  settings.*kind.member = value.choice(kOffOn) != 0;
}
void read(const SwitchValue& kind, const FlagValue& value, RenderSettings& settings) {
  settings.*kind.member = value.choice(kOffOn) != 0;
}
void read(const WholeValue& kind, const FlagValue& value, RenderSettings& settings) {
  settings.*kind.member = value.whole_number(kind.lowest, kind.highest);
}
void read(const NumberValue& kind, const FlagValue& value, RenderSettings& settings) {
  kind.in(settings) = value.number(kind.lowest, kind.highest);
}
void read(const PositiveValue& kind, const FlagValue& value, RenderSettings& settings) {
  settings.*kind.member = value.positive_number();
}
void read(const OptionalNumberValue& kind, const FlagValue& value, RenderSettings& settings) {
  settings.*kind.member = value.number(kind.lowest, kind.highest);
}
void read(const RadianceValue& kind, const FlagValue& value, RenderSettings& settings) {
  const glm::dvec3 radiance = value.triple();
  if (glm::any(glm::lessThan(radiance, glm::dvec3(0.0)))) value.refuse("is negative", "give radiance of zero or more");
  if (glm::any(glm::greaterThan(radiance, glm::dvec3(kind.highest))))
    value.refuse("is too large", fmt::format("give at most {}", kind.highest));
  settings.*kind.member = glm::vec3(radiance);
}
void read(const IntegratorValue&, const FlagValue& value, RenderSettings& settings) {
  settings.integrator = integrator_values()[value.choice(integrator_names())];
}
void read(const SpecialValue& kind, const FlagValue& value, RenderSettings& settings) { kind.read(value, settings); }

std::string text(const ChoiceValue& kind, const RenderSettings& settings) {
  return std::string(kind.names[settings.*kind.member]);
}
std::string text(const OnOffValue& kind, const RenderSettings& settings) {
  return std::string(kOffOn[settings.*kind.member]);
}
std::string text(const SwitchValue& kind, const RenderSettings& settings) {
  return std::string(kOffOn[settings.*kind.member]);
}
std::string text(const WholeValue& kind, const RenderSettings& settings) {
  return fmt::format("{}", number_of(kind, settings));
}
std::string text(const NumberValue& kind, const RenderSettings& settings) {
  return fmt::format("{}", kind.in(settings));
}
std::string text(const PositiveValue& kind, const RenderSettings& settings) {
  return settings.*kind.member > 0.0 ? fmt::format("{}", settings.*kind.member) : "";
}
std::string text(const OptionalNumberValue& kind, const RenderSettings& settings) {
  const std::optional<double>& number = settings.*kind.member;
  return number ? fmt::format("{}", *number) : "";
}
std::string text(const RadianceValue& kind, const RenderSettings& settings) {
  const std::optional<glm::vec3>& radiance = settings.*kind.member;
  return radiance ? fmt::format("{},{},{}", radiance->r, radiance->g, radiance->b) : "";
}
std::string text(const IntegratorValue&, const RenderSettings& settings) {
  return std::string(name_of(settings.integrator));
}
std::string text(const SpecialValue& kind, const RenderSettings& settings) { return kind.text(settings); }

// "a", "a or b", "a, b or c".
std::string names_text(const std::function<bool(const IntegratorSetting&)>& wanted) {
  std::vector<std::string_view> names;
  for (const IntegratorSetting& value : integrator_values())
    if (wanted(value)) names.push_back(name_of(value));
  if (names.empty()) return "";
  const std::string_view last = names.back();
  names.pop_back();
  return fmt::format("{}{}{}", fmt::join(names, ", "), names.empty() ? "" : " or ", last);
}

} // namespace

std::vector<IntegratorSetting> integrator_values() {
  std::vector<IntegratorSetting> values(integrators().begin(), integrators().end());
  values.insert(values.begin() + 1, IntegratorSetting::automatic());
  return values;
}

std::string_view name_of(const IntegratorSetting& integrator) {
  return integrator.is_auto() ? "auto" : integrator->name;
}

void read_setting(const Setting& setting, const std::string& text, RenderSettings& settings) {
  const FlagValue value{fmt::format("--{}", setting.name), text};
  std::visit([&](const auto& kind) { read(kind, value, settings); }, setting.value);
}

std::string text_of(const Setting& setting, const RenderSettings& settings) {
  return std::visit([&](const auto& kind) { return text(kind, settings); }, setting.value);
}

std::string flag_text(const Setting& setting, const RenderSettings& settings) {
  const std::string value = text_of(setting, settings);
  const auto* choice = std::get_if<ChoiceValue>(&setting.value);
  const bool may_be_bare = choice && !choice->bare.empty();
  const bool is_switch = std::holds_alternative<SwitchValue>(setting.value) || (may_be_bare && value == choice->bare);
  if (value.empty() || (is_switch && value == "off") || (may_be_bare && is_default(setting, settings))) return "";
  return is_switch ? fmt::format("--{}", setting.name) : fmt::format("--{} {}", setting.name, shell_quoted(value));
}

bool is_default(const Setting& setting, const RenderSettings& settings) {
  return text_of(setting, settings) == text_of(setting, RenderSettings{});
}

std::vector<std::string_view> choices_of(const Setting& setting) {
  if (std::holds_alternative<IntegratorValue>(setting.value)) return integrator_names();
  if (std::holds_alternative<OnOffValue>(setting.value)) return {"on", "off"};
  const auto* choice = std::get_if<ChoiceValue>(&setting.value);
  return choice ? std::vector(choice->names.begin(), choice->names.end()) : std::vector<std::string_view>();
}

std::uint32_t number_of(const WholeValue& value, const RenderSettings& settings) {
  const std::uint32_t number = settings.*value.member;
  return number == 0 && value.instead_of_0 ? settings.*value.instead_of_0 : number;
}

bool is_supported(const Setting& setting, const IntegratorKind& kind) {
  return setting.supported_by == SupportedBy::all || supports(kind, setting.name);
}

bool is_supported(const Setting& setting, const RenderSettings& settings) {
  return setting.supported_by == SupportedBy::all || supports(settings.integrator, setting.name);
}

bool is_auto(const Setting& setting, const RenderSettings& settings) {
  return is_supported(setting, settings) && text_of(setting, settings) == "auto";
}

std::string supporters_text(std::string_view setting) {
  return names_text([&](const IntegratorSetting& value) { return supports(value, setting); });
}

std::string aov_supporters_text(std::string_view aov) {
  return names_text([&](const IntegratorSetting& value) { return std::ranges::count(value->aovs, aov) > 0; });
}

} // namespace wavepath
