// Flags of a command: how they are declared, read and refused. One declaration gives parsing, help text and messages.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

// Of CLI11, whose headers compile slowly. Only what asks the parser for more than these functions do includes them.
namespace CLI {
class App;
class Option;
} // namespace CLI

namespace wavepath {

// The text that the user gave to a flag; what it cannot be read as is refused with a UsageError that names the flag.
struct FlagValue {
  std::string flag; // "--spp"
  std::string text;

  std::uint32_t whole_number(std::uint64_t lowest, std::uint64_t highest) const;
  double number(double lowest, double highest) const;                  // finite, both ends included
  double positive_number() const;                                      // finite
  glm::dvec3 triple() const;                                           // "X,Y,Z", finite
  std::uint32_t choice(std::span<const std::string_view> names) const; // index of one of the names
  [[noreturn]] void refuse(const std::string& problem, const std::string& remedy) const;
};

struct Flag {
  const char* names;        // "-o,--output", or "SCENE" for an argument without a dash
  const char* placeholder;  // what stands for the value in help: "FILE"; empty for a switch
  const char* meaning;      // one sentence with the unit
  const char* initial = ""; // the default in words; empty = none
};

// A command of `app`, with --help. `footer`: what its help ends with, if not as that of `app`.
CLI::App* add_command(CLI::App& app, const char* name, const char* meaning, const char* footer = nullptr);

// The last one given counts, unless `repeatable`, when `read` is called for each. An argument without a dash that is
// `repeatable` takes as many words as there are.
CLI::Option* add_flag(CLI::App& app, const char* group, const Flag& flag, std::function<void(const FlagValue&)> read,
                      bool repeatable = false);
void require(CLI::Option* option); // a command line without it is refused
void add_switch(CLI::App& app, const char* group, const Flag& flag, bool& value);

// The name among `names` that is nearest to `text` by edit distance; empty if none is near enough to be meant.
std::string nearest_name(const std::string& text, std::span<const std::string> names);

// A remedy for a name that is not there: "did you mean X?", or the list of what there is.
std::string suggestion(const std::string& text, std::span<const std::string> names);

inline constexpr const char* kHelpGroup = "Help"; // of --help and --version

// Lays out --help of `app` and its commands: usage, then the flags by group, each with its meaning and default.
void set_help_layout(CLI::App& app);

} // namespace wavepath
