// Available host memory from /proc/meminfo, cgroup v2 and the address-space limit.
#include "host/base/memory.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <sys/resource.h>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

// The number after `key` in a file of "key: number" lines, times `unit`.
std::uint64_t read_entry(const char* path, const std::string& key, std::uint64_t unit) {
  std::ifstream file(path);
  for (std::string name; file >> name;) {
    std::uint64_t value = 0;
    if (name == key && file >> value) return value * unit;
    file.clear();
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return kUnknown;
}

std::uint64_t read_number(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t value = 0;
  return file >> value ? value : kUnknown; // "max" is not a number
}

std::uint64_t left_of(std::uint64_t limit, std::uint64_t used) {
  if (limit == kUnknown || used == kUnknown) return kUnknown;
  return limit > used ? limit - used : 0;
}

// The tightest limit from the process's own group up to the root. Page cache counts as used there but can be dropped.
std::uint64_t left_in_control_group() {
  std::ifstream membership("/proc/self/cgroup");
  std::string line, group;
  while (std::getline(membership, line))
    if (line.rfind("0::", 0) == 0) group = line.substr(3);
  std::uint64_t least = kUnknown;
  for (std::string path = group; !path.empty(); path.resize(path.find_last_of('/'))) {
    const std::string folder = "/sys/fs/cgroup" + (path == "/" ? std::string() : path);
    const std::uint64_t used = read_number(folder + "/memory.current");
    const std::uint64_t cache = read_entry((folder + "/memory.stat").c_str(), "inactive_file", 1);
    if (used != kUnknown)
      least = std::min(
          least, left_of(read_number(folder + "/memory.max"), used - (cache == kUnknown ? 0 : std::min(cache, used))));
  }
  return least;
}

std::uint64_t left_in_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnknown;
  return left_of(limit.rlim_cur, read_entry("/proc/self/status", "VmSize:", 1024));
}

} // namespace

std::uint64_t available_memory() {
  return std::min(
      {read_entry("/proc/meminfo", "MemAvailable:", 1024), left_in_control_group(), left_in_address_space()});
}

void require_memory(const std::string& where, const std::string& what, std::uint64_t bytes, const std::string& remedy,
                    std::uint64_t available) {
  if (bytes > available)
    throw Error(
        where,
        fmt::format("{} takes {} of memory, and {} is available", what, to_size_text(bytes), to_size_text(available)),
        remedy);
}

std::string to_size_text(std::uint64_t bytes) {
  constexpr const char* kUnits[] = {"bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  std::size_t unit = 0;
  double value = static_cast<double>(bytes);
  while (value >= 1024.0 && unit + 1 < std::size(kUnits)) value /= 1024.0, ++unit;
  return unit == 0 ? fmt::format("{} bytes", bytes) : fmt::format("{:.1f} {}", value, kUnits[unit]);
}

} // namespace wavepath
