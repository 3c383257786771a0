// Parameters of a pbrt directive: "type name" and values.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/convert/pbrt_tokens.h"

namespace wavepath::convert {

struct PbrtParam {
  std::string type, name;
  std::vector<double> numbers;
  std::vector<std::string> strings; // bools too
  mutable bool is_used = false;
};

struct PbrtParams {
  std::vector<PbrtParam> all;

  // Marks it as used; null if there is none. `type`: empty for any.
  const PbrtParam* find(std::string_view name, std::string_view type = {}) const;
  bool has(std::string_view name) const { return find(name) != nullptr; }
  double number(std::string_view name, double otherwise) const;
  std::string text(std::string_view name, const std::string& otherwise) const;
  bool flag(std::string_view name, bool otherwise) const;
};

// Those that follow. Values are bounded by the file.
PbrtParams read_params(PbrtTokens& tokens);
// A number alone, or in brackets.
double read_number(PbrtTokens& tokens);
std::string read_string(PbrtTokens& tokens);

} // namespace wavepath::convert
