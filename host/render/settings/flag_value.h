// Text that a user gives to a flag: reads it as a value, or refuses it and suggests what was probably meant.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath {

// Flag and text. Every reader below throws a UsageError that names the flag if the text is no such value. Limits are
// inclusive.
struct FlagValue {
  std::string flag; // "--spp"
  std::string text;

  std::uint32_t whole_number(std::uint64_t lowest, std::uint64_t highest) const;
  double number(double lowest, double highest) const;                       // finite, both ends included
  double positive_number() const;                                           // finite
  glm::dvec3 triple() const;                                                // "X,Y,Z", finite
  std::vector<double> numbers(std::size_t count, const char* remedy) const; // separated by commas, finite
  std::uint32_t choice(std::span<const std::string_view> names) const;      // index of one of the names
  // The parts before and after the separator. `remedy`: how to write the value, for the error if there is no separator.
  std::pair<FlagValue, FlagValue> split(char separator, const char* remedy) const;
  // The parts of a list separated by commas, each one of `names`, in the order given and without repetitions.
  std::vector<std::string> list(std::span<const std::string_view> names) const;
  [[noreturn]] void refuse(const std::string& problem, const std::string& remedy) const;
};

// The name among `names` that is nearest to `text` by edit distance; empty if none is near enough to be meant.
std::string nearest_name(const std::string& text, std::span<const std::string> names);

// A remedy for a name that does not exist: "did you mean X?", or the list of existing names.
std::string suggestion(const std::string& text, std::span<const std::string> names);

} // namespace wavepath
