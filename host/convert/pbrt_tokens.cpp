#include "host/convert/pbrt_tokens.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/convert/mesh_files.h"

namespace wavepath::convert {
namespace {

constexpr std::size_t kMostOpenFiles = 32;

} // namespace

PbrtTokens::PbrtTokens(const std::string& path) : folder_(std::filesystem::path(path).parent_path()) { include(path); }

void PbrtTokens::include(const std::string& path) {
  if (files_.size() >= kMostOpenFiles) fail(fmt::format("includes files {} deep", kMostOpenFiles));
  for (const std::unique_ptr<File>& file : files_)
    if (file->path == path) fail("includes a file within itself");
  auto file = std::make_unique<File>();
  file->path = path;
  file->bytes = read_bytes(path);
  files_.push_back(std::move(file));
  done_.clear();
}

std::string PbrtTokens::resolved(const std::string& name) const {
  const std::filesystem::path path(name);
  return path.is_absolute() ? name : (folder_ / path).string();
}

void PbrtTokens::fail(const std::string& problem, const std::string& remedy) const {
  const File* file = !files_.empty() ? files_.back().get() : !done_.empty() ? done_.back().get() : nullptr;
  throw Error(file ? file->path : "pbrt", file ? fmt::format("line {}: {}", file->line, problem) : problem, remedy);
}

const PbrtToken& PbrtTokens::peek() {
  if (!has_peeked_) peeked_ = read();
  has_peeked_ = true;
  return peeked_;
}

PbrtToken PbrtTokens::next() {
  const PbrtToken token = peek();
  has_peeked_ = false;
  return token;
}

PbrtToken PbrtTokens::read() {
  while (!files_.empty()) {
    File& file = *files_.back();
    const std::string_view text(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
    std::size_t& at = file.at;
    while (at < text.size()) {
      const char c = text[at];
      if (c == '\n') ++file.line;
      if (c == '#')
        at = std::min(text.find('\n', at), text.size());
      else if (c == ' ' || c == '\t' || c == '\r' || c == '\n')
        ++at;
      else
        break;
    }
    if (at == text.size()) { // its words stay where they are until others are read
      done_.push_back(std::move(files_.back()));
      files_.pop_back();
      continue;
    }
    const std::size_t first = at;
    if (text[at] == '[' || text[at] == ']') {
      ++at;
      return {text[first] == '[' ? PbrtToken::Kind::open : PbrtToken::Kind::close, text.substr(first, 1)};
    }
    if (text[at] == '"') {
      for (++at; at < text.size() && text[at] != '"' && text[at] != '\n'; ++at)
        if (text[at] == '\\') ++at;
      if (at >= text.size() || text[at] != '"') fail("has a string that does not end");
      ++at;
      return {PbrtToken::Kind::string, text.substr(first + 1, at - first - 2)};
    }
    at = std::min(text.find_first_of(" \t\r\n[]\"#", at), text.size());
    return {PbrtToken::Kind::word, text.substr(first, at - first)};
  }
  return {};
}

} // namespace wavepath::convert
