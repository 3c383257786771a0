#include "host/base/output_files.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

namespace fs = std::filesystem;

struct NamedFile {
  std::string name;
  bool exists = false, regular = false;
  dev_t device = 0;
  ino_t inode = 0;
  fs::path target; // of one that does not exist
};

NamedFile described(const std::string& name, const struct stat& status) {
  return {name, true, S_ISREG(status.st_mode), status.st_dev, status.st_ino, {}};
}

NamedFile named_file(const std::string& name) {
  struct stat status {};
  if (::stat(name.c_str(), &status) == 0) return described(name, status);
  return {.name = name, .target = target_of(name)};
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// True if names that differ in case alone are one file in this folder: a temporary file is made to find out.
bool ignores_case(const fs::path& folder) {
  std::string lower = (folder / fmt::format(".wavepath-case-{}-XXXXXX", ::getpid())).string();
  const int descriptor = ::mkostemp(lower.data(), O_CLOEXEC);
  if (descriptor < 0) return false; // nothing can be written there anyway
  ::close(descriptor);
  const std::string upper = (folder / fs::path(lower).filename().string().replace(1, 8, "WAVEPATH")).string();
  const bool found = ::access(upper.c_str(), F_OK) == 0;
  ::unlink(lower.c_str());
  return found;
}

bool same_file(const NamedFile& a, const NamedFile& b) {
  if (a.exists != b.exists) return false;
  if (a.exists) return a.regular && a.device == b.device && a.inode == b.inode;
  if (a.target == b.target) return true;
  const fs::path folder = a.target.parent_path();
  return folder == b.target.parent_path() &&
         lower_case(a.target.filename().string()) == lower_case(b.target.filename().string()) && ignores_case(folder);
}

bool names_descriptor(const std::string& name) { return name.starts_with("/dev/") || name.starts_with("/proc/"); }

} // namespace

fs::path target_of(const std::string& name) {
  constexpr int kMostLinks = 40; // as Linux follows
  std::error_code error;
  fs::path path = name;
  for (int i = 0; i < kMostLinks && !fs::exists(path, error) && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    const fs::path target = fs::read_symlink(path, error);
    if (error) break;
    path = path.parent_path() / target; // which an absolute one replaces
  }
  if (path.is_relative() && !path.has_parent_path()) path = fs::path(".") / path; // else it stays relative if it is new
  const fs::path resolved = fs::weakly_canonical(path, error);
  return error ? path : resolved;
}

void refuse_overwriting(std::span<const std::string> outputs, std::span<const std::string> inputs) {
  std::vector<NamedFile> read, written;
  for (const std::string& name : inputs)
    if (!name.empty()) read.push_back(named_file(name));
  constexpr const char* kStreams[] = {"stdout", "stderr"};
  std::vector<NamedFile> streams;
  for (int i = 0; i < 2; ++i) {
    struct stat status {};
    if (::fstat(STDOUT_FILENO + i, &status) == 0) streams.push_back(described(kStreams[i], status));
  }
  const auto find = [](const std::vector<NamedFile>& files, const NamedFile& file) {
    return std::ranges::find_if(files, [&](const NamedFile& other) { return same_file(file, other); });
  };
  for (const std::string& name : outputs) {
    const NamedFile file = named_file(name);
    if (const auto input = find(read, file); input != read.end())
      throw UsageError(
          name,
          input->name == name ? "would overwrite an input" : fmt::format("would overwrite an input, {}", input->name),
          "write somewhere else");
    if (const auto other = find(written, file); other != written.end())
      throw UsageError(name,
                       other->name == name ? "is written twice" : fmt::format("is the same file as {}", other->name),
                       "give every output a name of its own");
    if (const auto stream = find(streams, file); stream != streams.end() && !names_descriptor(name))
      throw UsageError(name, fmt::format("is where {} goes", stream->name), "give every output a name of its own");
    written.push_back(file);
  }
}

} // namespace wavepath
