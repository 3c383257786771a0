#include "host/gpu/device_choice.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

int preference(const DeviceInfo& info) {
  if (info.type == "discrete") return 4;
  if (info.type == "integrated") return 3;
  if (info.type == "virtual") return 2;
  return info.type == "cpu" ? 1 : 0;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool has_number(const std::string& name, const std::string& number) {
  const auto is_digit = [&](std::size_t at) {
    return at < name.size() && std::isdigit(static_cast<unsigned char>(name[at]));
  };
  if (number.size() < 3) return false;
  for (std::size_t at = name.find(number); at != std::string::npos; at = name.find(number, at + 1))
    if (!(at > 0 && is_digit(at - 1)) && !is_digit(at + number.size())) return true;
  return false;
}

} // namespace

std::string driver_remedy() {
  std::string set;
  for (const char* name : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES", "VK_LOADER_DRIVERS_SELECT",
                           "VK_LOADER_DRIVERS_DISABLE"})
    if (const char* value = std::getenv(name); value && *value)
      set += fmt::format("{}{} is '{}'", set.empty() ? "" : " and ", name, value);
  if (set.empty()) return "install a driver; mesa-vulkan-drivers has one for any CPU";
  return fmt::format("{}, which hides the drivers: unset it, or name the .json file of one that is installed", set);
}

std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& wanted) {
  if (devices.empty()) throw Error("Vulkan", "no device found", driver_remedy());
  std::string known;
  for (std::size_t i = 0; i < devices.size(); ++i) known += fmt::format("{}{} = {}", i ? ", " : "", i, devices[i].name);

  std::size_t chosen = devices.size();
  // A number that is no index may be part of a name, as of an "Arc A770": all of a number there, of three digits or
  // more.
  const bool is_number = !wanted.empty() && std::all_of(wanted.begin(), wanted.end(), ::isdigit) && wanted.size() < 6;
  const bool is_index = is_number && std::stoul(wanted) < devices.size();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (wanted.empty()) {
      const bool better = chosen == devices.size() || preference(devices[i]) > preference(devices[chosen]);
      if (devices[i].missing.empty() && better) chosen = i;
    } else if (is_index    ? std::stoul(wanted) == i
               : is_number ? has_number(devices[i].name, wanted)
                           : lower(devices[i].name).find(lower(wanted)) != std::string::npos) {
      chosen = i;
      break;
    }
  }
  if (chosen == devices.size() && !wanted.empty())
    throw Error("--device " + wanted, "no such device", "choose one of: " + known);
  if (chosen == devices.size() || !devices[chosen].missing.empty()) {
    const DeviceInfo& info = devices[chosen == devices.size() ? 0 : chosen];
    throw Error(info.name, "lacks " + info.missing.front(), "update its driver or choose another device: " + known);
  }
  return chosen;
}

} // namespace wavepath
