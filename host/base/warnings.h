// Warnings are collected, not printed: once per kind with a count; main prints them.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace wavepath {

class Warnings {
public:
  void add(const std::string& text, std::size_t count = 1) { counts_[text] += count; }
  const std::map<std::string, std::size_t>& counts() const { return counts_; }
  bool empty() const { return counts_.empty(); }

private:
  std::map<std::string, std::size_t> counts_;
};

} // namespace wavepath
