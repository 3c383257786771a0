// A file that is replaced atomically: data go to a temporary file beside the target, which is then renamed over it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace wavepath {

class AtomicFile {
public:
  // Opens a temporary file in the folder of `target` (links are followed). A target that exists and is no regular file,
  // such as a pipe or /dev/stdout, is written directly. Throws Error if that cannot be done.
  explicit AtomicFile(const std::string& target);
  ~AtomicFile(); // removes the temporary file if commit() was not called
  AtomicFile(AtomicFile&&) = delete;

  // All throw Error, naming the target, when the disk is full or fails.
  void write(const void* data, std::size_t bytes);
  void seek(std::uint64_t position);
  std::uint64_t position() const { return position_; }

  // Flushes to the disk and renames over the target.
  void commit();

private:
  [[noreturn]] void fail(const char* doing) const;

  std::string target_, temporary_; // temporary_ is empty when the target is written directly
  int descriptor_ = -1;
  std::uint64_t position_ = 0;
};

// Writes a whole file.
void write_file(const std::string& target, const std::string& contents);

// Throws Error if `target` could not be written later: its folder is missing, it is a folder, or permission is lacking.
// Leaves nothing behind.
void require_writable(const std::string& target);

} // namespace wavepath
