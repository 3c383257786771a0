// Warnings are collected with a count of each text, and printed by the command.
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
