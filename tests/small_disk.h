// A disk that is full as soon as a test wants it to be, mounted on a folder for this process and its children alone.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "tests/run_wavepath.h"

namespace wavepath::test {

// Where this system lets nobody but root mount, files may only not grow beyond a size: much the same for the program,
// but drivers that keep device memory in files (Mesa 25) fail there too.
class SmallDisk {
public:
  // What is in the folder is hidden until the end.
  explicit SmallDisk(const std::filesystem::path& folder) : folder_(folder) {
    if (unshare(needs_user() ? CLONE_NEWUSER | CLONE_NEWNS : CLONE_NEWNS) != 0 || !map_user()) return;
    mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr); // fails under chroot, where others may see the disk
    mounted_ = mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=64m") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(SmallDisk&&) = delete;

  // From now on the disk takes so many bytes more.
  void leave(std::uint64_t bytes) {
    left_ = bytes;
    if (!mounted_) return;
    struct statvfs now {};
    if (statvfs(folder_.c_str(), &now) != 0) throw std::runtime_error("no disk");
    const std::uint64_t used = (now.f_blocks - now.f_bfree) * now.f_frsize;
    const std::string size = fmt::format("size={}", used + bytes);
    if (mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT, size.c_str()) != 0) throw std::runtime_error("no disk");
  }
  // For a program that writes there.
  RunOptions options() const {
    RunOptions options;
    if (!mounted_)
      options.in_child = [left = left_] {
        const rlimit limit{left, left};
        setrlimit(RLIMIT_FSIZE, &limit);
        setenv("MESA_SHADER_CACHE_DISABLE", "1", 1); // its files would hit the limit too
      };
    return options;
  }

private:
  static bool needs_user() { return geteuid() != 0; }
  // The user of this process is the same inside.
  static bool map_user() {
    static const uid_t user = getuid();
    if (user == 0) return true;
    const auto write = [](const char* file, const std::string& text) { return bool(std::ofstream(file) << text); };
    return write("/proc/self/setgroups", "deny") && write("/proc/self/uid_map", fmt::format("{0} {0} 1", user));
  }

  std::filesystem::path folder_;
  std::uint64_t left_ = 0;
  bool mounted_ = false;
};

} // namespace wavepath::test
