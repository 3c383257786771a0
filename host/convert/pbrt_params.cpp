#include "host/convert/pbrt_params.h"

#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace wavepath::convert {
namespace {

std::optional<double> to_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || end == text.data()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return 0.0; // below what a double holds
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

void add_value(PbrtTokens& tokens, PbrtParam& param, const PbrtToken& token) {
  if (token.kind == PbrtToken::Kind::string) {
    param.strings.emplace_back(token.text);
  } else if (token.text == "true" || token.text == "false") {
    param.strings.emplace_back(token.text);
  } else if (const std::optional<double> number = to_number(token.text)) {
    param.numbers.push_back(*number);
  } else {
    tokens.fail(fmt::format("'{}' is no value of \"{} {}\"", token.text.substr(0, 40), param.type, param.name));
  }
}

} // namespace

const PbrtParam* PbrtParams::find(std::string_view name, std::string_view type) const {
  for (const PbrtParam& param : all)
    if (param.name == name && (type.empty() || param.type == type)) {
      param.is_used = true;
      return &param;
    }
  return nullptr;
}

double PbrtParams::number(std::string_view name, double otherwise) const {
  const PbrtParam* param = find(name);
  return param && !param->numbers.empty() ? param->numbers[0] : otherwise;
}

std::string PbrtParams::text(std::string_view name, const std::string& otherwise) const {
  const PbrtParam* param = find(name);
  return param && !param->strings.empty() ? param->strings[0] : otherwise;
}

bool PbrtParams::flag(std::string_view name, bool otherwise) const {
  const PbrtParam* param = find(name);
  return param && !param->strings.empty() ? param->strings[0] == "true" : otherwise;
}

PbrtParams read_params(PbrtTokens& tokens) {
  PbrtParams params;
  while (tokens.peek().kind == PbrtToken::Kind::string) {
    const std::string_view declaration = tokens.next().text;
    const std::size_t type_end = declaration.find_first_of(" \t");
    const std::size_t name = declaration.find_first_not_of(" \t", type_end);
    if (type_end == std::string_view::npos || name == std::string_view::npos)
      tokens.fail(fmt::format("\"{}\" is no parameter: a type and a name are expected", declaration.substr(0, 40)));
    PbrtParam param;
    param.type = declaration.substr(0, type_end);
    param.name = declaration.substr(name, declaration.find_last_not_of(" \t") + 1 - name);
    PbrtToken value = tokens.next();
    if (value.kind == PbrtToken::Kind::open) {
      for (value = tokens.next(); value.kind != PbrtToken::Kind::close; value = tokens.next()) {
        if (value.kind == PbrtToken::Kind::end || value.kind == PbrtToken::Kind::open)
          tokens.fail("has a list that does not end");
        add_value(tokens, param, value);
      }
    } else if (value.kind == PbrtToken::Kind::end || value.kind == PbrtToken::Kind::close) {
      tokens.fail(fmt::format("\"{}\" has no value", declaration.substr(0, 40)));
    } else {
      add_value(tokens, param, value);
    }
    params.all.push_back(std::move(param));
  }
  return params;
}

double read_number(PbrtTokens& tokens) {
  const PbrtToken token = tokens.next();
  const std::optional<double> number = to_number(token.text);
  if (token.kind != PbrtToken::Kind::word || !number)
    tokens.fail(fmt::format("'{}' is no number", token.text.substr(0, 40)));
  return *number;
}

std::string read_string(PbrtTokens& tokens) {
  const PbrtToken token = tokens.next();
  if (token.kind != PbrtToken::Kind::string)
    tokens.fail(token.kind == PbrtToken::Kind::end
                    ? std::string("ends where a string is expected")
                    : fmt::format("'{}' stands where a string is expected", token.text.substr(0, 40)));
  return std::string(token.text);
}

} // namespace wavepath::convert
