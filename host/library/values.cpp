// Errors, settings and version: the values of the interface.
#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <wavepath/error.h>
#include <wavepath/settings.h>
#include <wavepath/version.h>

namespace wavepath_v0 {

Error::Error(const std::string& where, const std::string& problem, const std::string& remedy)
    : std::runtime_error(where + ": " + problem + "; " + remedy), where_(where), problem_(problem), remedy_(remedy) {}
Error::~Error() = default;
UsageError::~UsageError() = default;

std::string Value::text_of(double number) { return fmt::format("{}", number); }

Settings& Settings::set(std::string name, Value value) {
  std::ranges::replace(name, '_', '-');
  const auto found = std::ranges::find(all_, name, &Setting::name);
  if (found != all_.end())
    found->value = std::move(value);
  else
    all_.push_back({std::move(name), std::move(value)});
  return *this;
}

Settings& Settings::add(const Settings& others) {
  for (const Setting& setting : others.all()) set(setting.name, setting.value);
  return *this;
}

const char* version() { return WAVEPATH_VERSION; }

} // namespace wavepath_v0
