// Atomic output files over POSIX descriptors, every call checked: a full disk is an error, never a truncated picture.
#include "host/base/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/output_files.h"

namespace wavepath {
namespace {

namespace fs = std::filesystem;

bool is_special(const fs::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

void refuse_hopeless(const std::string& target, const fs::path& path) {
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (target.empty()) throw Error("output", "the file name is empty", "name a file");
  if (fs::is_directory(path, error)) throw Error(target, "is a folder", "name a file in it");
  if (!fs::exists(folder, error))
    throw Error(target, fmt::format("the folder '{}' does not exist", folder.string()), "create it first");
  if (!fs::is_directory(folder, error))
    throw Error(target, fmt::format("'{}' is not a folder", folder.string()), "name another folder");
  if (fs::exists(path, error) && ::access(path.c_str(), W_OK) != 0)
    throw Error(target, fmt::format("cannot be written ({})", std::strerror(errno)), "check its permissions");
}

} // namespace

AtomicFile::AtomicFile(const std::string& target) : target_(target) {
  const fs::path path = target_of(target); // so that a link is not replaced by a regular file
  refuse_hopeless(target, path);
  if (is_special(path)) {
    // The name as given: /dev/stdout resolves to a pipe that has no path of its own.
    descriptor_ = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("open");
    return;
  }
  target_ = path.string();
  static std::atomic<unsigned> serial{0};
  temporary_ = (path.parent_path() / fmt::format(".wavepath-{}-{}.tmp", ::getpid(), serial++)).string();
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    temporary_.clear();
    fail("create a file beside it");
  }
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::fail(const char* doing) const {
  throw Error(target_, fmt::format("cannot {} ({})", doing, std::strerror(errno)),
              errno == ENOSPC || errno == EDQUOT || errno == EFBIG ? "free some space or write elsewhere"
                                                                   : "check the folder and its permissions");
}

void AtomicFile::write(const void* data, std::size_t bytes) {
  const char* next = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t written = ::write(descriptor_, next, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("write");
    next += written;
    bytes -= static_cast<std::size_t>(written);
    position_ += static_cast<std::uint64_t>(written);
  }
}

void AtomicFile::seek(std::uint64_t position) {
  if (position == position_) return;
  if (::lseek(descriptor_, static_cast<off_t>(position), SEEK_SET) < 0) fail("seek");
  position_ = position;
}

void AtomicFile::commit() {
  // Some file systems report a full disk only here. Pipes and terminals do not support fsync.
  if (!temporary_.empty() && ::fsync(descriptor_) != 0) fail("write");
  const int descriptor = std::exchange(descriptor_, -1);
  if (::close(descriptor) != 0) fail("close");
  if (temporary_.empty()) return;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail("replace");
  temporary_.clear();
}

void write_file(const std::string& target, const std::string& contents) {
  AtomicFile file(target);
  file.write(contents.data(), contents.size());
  file.commit();
}

void require_writable(const std::string& target) { AtomicFile probe(target); }

} // namespace wavepath
