// Settings by the names of the flags of `wavepath render`: --max-depth 4 is {"max-depth", 4}.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <wavepath/export.h>

namespace wavepath_v0 {

// A value of a setting: text, a number, on or off, or a list of texts or numbers.
class WAVEPATH_API Value {
public:
  enum class Kind { text, on_off, list };

  Value(const char* text) : texts{text} {}
  Value(std::string text) : texts{std::move(text)} {}
  Value(std::vector<std::string> list) : kind(Kind::list), texts(std::move(list)) {}
  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  Value(Number number) {
    if constexpr (std::is_same_v<Number, bool>)
      kind = Kind::on_off, texts = {number ? "on" : "off"};
    else if constexpr (std::is_integral_v<Number>)
      texts = {std::to_string(number)};
    else
      texts = {text_of(static_cast<double>(number))};
  }
  template <class Number, std::size_t kCount, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  Value(const std::array<Number, kCount>& numbers) : kind(Kind::list) {
    for (const Number number : numbers) texts.push_back(Value(number).texts.front());
  }

  Kind kind = Kind::text;
  std::vector<std::string> texts; // one, unless it is a list

private:
  static std::string text_of(double number); // the shortest that reads back to the same number
};

struct Setting {
  std::string name; // of the flag without its dashes; `_` may stand for `-`
  Value value;
};

// Later ones replace earlier ones of the same name. They are checked where they are used, with the messages of the
// command line.
class WAVEPATH_API Settings {
public:
  Settings() = default;
  Settings(std::initializer_list<Setting> settings) : all_(settings) {}

  Settings& set(std::string name, Value value);
  Settings& add(const Settings& others);
  const std::vector<Setting>& all() const { return all_; }

private:
  std::vector<Setting> all_;
};

} // namespace wavepath_v0
