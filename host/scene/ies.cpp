// Parses the text of LM-63 files, and fills in what they leave out by symmetry; see ies.h.
#include "host/scene/ies.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/base/error.h"

namespace wavepath {
namespace {

constexpr double kMostAngles = 4096.0, kMostValue = 1e30;
constexpr double kSameAngle = 1e-3; // degrees, by which files miss 0, 90, 180 and 360

struct Parser {
  const std::string& file;
  const std::string& what;
  std::string_view rest;

  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(file, what + " " + problem, "replace it with a sound IES LM-63 file");
  }

  std::string_view line() {
    const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
    const std::string_view text = rest.substr(0, end);
    rest.remove_prefix(end);
    if (rest.starts_with("\r\n")) rest.remove_prefix(1);
    if (!rest.empty()) rest.remove_prefix(1);
    return text;
  }

  double number(const char* name) {
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n,"), rest.size()));
    if (rest.starts_with('+')) rest.remove_prefix(1);
    double value = 0.0;
    const auto parsed = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (parsed.ec != std::errc() || !std::isfinite(value) || std::abs(value) > kMostValue)
      fail(std::string("has no ") + name + " where one belongs");
    rest.remove_prefix(static_cast<std::size_t>(parsed.ptr - rest.data()));
    return value;
  }

  std::size_t count(const char* name) {
    const double value = number(name);
    if (!(value >= 1.0 && value <= kMostAngles) || value != std::floor(value))
      fail(std::string("has ") + std::to_string(value) + " as its " + name);
    return static_cast<std::size_t>(value);
  }

  std::vector<double> angles(std::size_t count, const char* name) {
    std::vector<double> result;
    for (std::size_t i = 0; i < count; ++i) result.push_back(number(name));
    if (std::ranges::adjacent_find(result, std::greater_equal<double>()) != result.end())
      fail(std::string("has ") + name + "s that do not ascend");
    return result;
  }
};

bool is_at(double angle, double degrees) { return std::abs(angle - degrees) <= kSameAngle; }

// Columns of a whole turn: indices of those of the file, by their angle.
struct Column {
  double degrees;
  std::size_t index;
};

// What a file leaves out by symmetry, filled in: about a plane for 0 to 180 and for 90 to 270 degrees, about two for 0
// to 90.
std::vector<Column> whole_turn(const Parser& parser, const std::vector<double>& angles) {
  std::vector<Column> columns;
  for (std::size_t i = 0; i < angles.size(); ++i) columns.push_back({angles[i], i});
  const auto mirror = [&](double sum) { // of both angles; the plane lies at half of it
    for (std::size_t i = columns.size(); i-- > 0;)
      if (const Column column = columns[i]; !is_at(2.0 * column.degrees, sum))
        columns.push_back({sum - column.degrees, column.index});
  };
  const double first = angles.front(), last = angles.back();
  if (angles.size() == 1) return {{0.0, 0}};
  if (is_at(first, 0.0) && is_at(last, 90.0)) {
    mirror(180.0);
    mirror(360.0);
  } else if (is_at(first, 0.0) && is_at(last, 180.0)) {
    mirror(360.0);
  } else if (is_at(first, 90.0) && is_at(last, 270.0)) {
    mirror(180.0);
  } else if (!is_at(first, 0.0) || last < 180.0 || last > 360.0 + kSameAngle) {
    parser.fail("covers horizontal angles from " + std::to_string(first) + " to " + std::to_string(last) + " degrees");
  }
  for (Column& column : columns)
    if (column.degrees < 0.0) column.degrees += 360.0;
  std::ranges::sort(columns, {}, &Column::degrees);
  const auto same = [](const Column& a, const Column& b) { return is_at(a.degrees, b.degrees); };
  columns.erase(std::unique(columns.begin(), columns.end(), same), columns.end());
  const Column front = columns.front(), back = columns.back();
  if (!is_at(front.degrees, 0.0)) columns.insert(columns.begin(), {back.degrees - 360.0, back.index});
  if (!is_at(back.degrees, 360.0)) columns.push_back({front.degrees + 360.0, front.index});
  return columns;
}

} // namespace

IesFile read_ies(const std::string& file, const std::string& what, std::string_view text) {
  Parser parser{file, what, text};
  const std::string_view version = parser.line();
  const bool is_old = !version.starts_with("IESNA:LM-63-") && !version.starts_with("IES:LM-63-");
  if (is_old && !version.starts_with("IESNA") && text.find("TILT=") == std::string_view::npos)
    parser.fail("is no IES LM-63 file");
  std::string_view line = version;
  while (!line.starts_with("TILT=")) {
    if (parser.rest.empty()) parser.fail("has no line TILT=");
    line = parser.line();
  }
  if (line.substr(5).starts_with("INCLUDE")) {
    parser.number("position of the lamp");
    const std::size_t count = parser.count("number of tilts");
    for (std::size_t i = 0; i < 2 * count; ++i) parser.number("tilt");
  }
  parser.number("number of lamps");
  parser.number("number of lumens");
  double factor = parser.number("candela multiplier");
  const std::size_t rows = parser.count("number of vertical angles"),
                    columns = parser.count("number of horizontal angles");
  const double type = parser.number("type of photometry");
  for (const char* name : {"type of units", "width", "length", "height"}) parser.number(name);
  factor *= parser.number("ballast factor");
  const double lamp_factor = parser.number("factor of ballast and lamp"); // of later versions: reserved
  if (is_old) factor *= lamp_factor;
  parser.number("number of watts");
  IesFile result;
  if (type == 2.0 || type == 3.0) {
    result.type = type == 2.0 ? 'B' : 'A';
    return result;
  }
  if (type != 1.0) parser.fail("has " + std::to_string(type) + " as its type of photometry");
  const std::vector<double> vertical = parser.angles(rows, "vertical angle"),
                            horizontal = parser.angles(columns, "horizontal angle");
  if (rows < 2 || vertical.front() < -kSameAngle || vertical.back() > 180.0 + kSameAngle)
    parser.fail("has vertical angles that type C cannot have");
  std::vector<double> candelas;
  for (std::size_t i = 0; i < rows * columns; ++i) {
    candelas.push_back(parser.number("candela value"));
    if (candelas.back() < 0.0) parser.fail("has a candela value below 0");
  }
  if (factor < 0.0) parser.fail("has a factor below 0");
  const double most = std::ranges::max(candelas);
  result.candela = most * factor;
  constexpr double kRadians = std::numbers::pi / 180.0;
  // Whole angles become those that kernels reach.
  const auto radians = [](double degrees, double whole) {
    if (is_at(degrees, 0.0)) return 0.0f;
    const auto angle = static_cast<float>(degrees * kRadians);
    return is_at(degrees, whole) ? std::nextafter(static_cast<float>(whole * kRadians), 10.0f) : angle;
  };
  for (const double angle : vertical) result.profile.vertical.push_back(radians(angle, 180.0));
  for (const Column& column : whole_turn(parser, horizontal)) {
    result.profile.horizontal.push_back(radians(column.degrees, 360.0));
    for (std::size_t row = 0; row < rows; ++row)
      result.profile.intensities.push_back(most > 0.0 ? static_cast<float>(candelas[column.index * rows + row] / most)
                                                      : 0.0f);
  }
  return result;
}

} // namespace wavepath
