// Flags of a command: one declaration gives parsing, help text and messages.
#pragma once

#include <functional>
#include <string>

#include "host/render/settings/flag_value.h"

// Parser of CLI11. Its headers compile slowly, so only files that need more of the parser than these functions include
// them.
namespace CLI {
class App;
class Option;
} // namespace CLI

namespace wavepath {

inline constexpr bool kAdvanced = true; // of Flag::advanced

struct Flag {
  std::string names;       // "-o,--output", or "SCENE" for an argument without a dash
  std::string placeholder; // of the value in help: "FILE"; empty for a switch
  std::string meaning;     // one clause with the unit
  std::string initial{};   // the default in words; empty = none
  bool advanced = false;   // for experts: --help leaves it out, --help-all shows it
};

// A command of `app`, with --help and --help-all. `footer`: what its help ends with, if not as that of `app`.
CLI::App* add_command(CLI::App& app, const char* name, const char* meaning, const char* footer = nullptr);

// The last one given counts, unless `repeatable`, when `read` is called for each. An argument without a dash that is
// `repeatable` takes as many words as there are.
CLI::Option* add_flag(CLI::App& app, const char* group, const Flag& flag, std::function<void(const FlagValue&)> read,
                      bool repeatable = false);
void require(CLI::Option* option); // a command line without it is refused
CLI::Option* add_switch(CLI::App& app, const char* group, const Flag& flag, bool& value);
void add_switch(CLI::App& app, const char* group, const Flag& flag, std::function<void(bool)> read);

inline constexpr const char* kHelpGroup = "Help"; // of --help and --version

// Lays out --help and --help-all of `app` and its commands: usage, then the flags by group, each with its meaning and
// default. To be called before commands are added.
void set_help_layout(CLI::App& app);
// --help of the command leaves the flag out. Without set_help_layout() nothing happens.
void leave_out_of_help(const CLI::App& command, const CLI::Option* flag);

} // namespace wavepath
