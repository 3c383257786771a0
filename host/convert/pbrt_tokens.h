// The words of a pbrt file, with the files that it includes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace wavepath::convert {

struct PbrtToken {
  enum class Kind : std::uint8_t { end, word, string, open, close };
  Kind kind = Kind::end;
  std::string_view text; // of a string without its quotes, as the file has it
};

class PbrtTokens {
public:
  explicit PbrtTokens(const std::string& path);

  PbrtToken next();
  const PbrtToken& peek();
  // The following words are those of the file, then it goes on here. A file that includes itself is refused.
  void include(const std::string& path);
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = "correct the file") const;
  // A path in the file: relative ones start in the folder of the scene.
  std::string resolved(const std::string& name) const;

private:
  struct File {
    std::string path;
    std::vector<std::uint8_t> bytes;
    std::size_t at = 0;
    std::uint64_t line = 1;
  };
  PbrtToken read();

  std::vector<std::unique_ptr<File>> files_;
  std::vector<std::unique_ptr<File>> done_; // whose words may still be looked at
  std::filesystem::path folder_;
  PbrtToken peeked_;
  bool has_peeked_ = false;
};

} // namespace wavepath::convert
