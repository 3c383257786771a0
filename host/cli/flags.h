// Flags of a command: one declaration gives parsing, help text and messages.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "host/render/flag_value.h"

namespace wavepath {

struct Flag {
  std::string names;       // "-o,--output", or "SCENE" for an argument without a dash
  std::string placeholder; // of the value in help: "FILE"; empty for a switch
  std::string meaning;     // one clause with the unit
  std::string initial{};   // the default in words; empty = none
};

// The last one given counts, unless `repeatable`, when `read` is called for each.
CLI::Option* add_flag(CLI::App& app, const char* group, const Flag& flag, std::function<void(const FlagValue&)> read,
                      bool repeatable = false);
void add_switch(CLI::App& app, const char* group, const Flag& flag, bool& value);
void add_switch(CLI::App& app, const char* group, const Flag& flag, std::function<void(bool)> read);

inline constexpr const char* kHelpGroup = "Help"; // of --help and --version

// Lays out --help: usage, then the flags by group, each with its meaning and default.
class HelpLayout : public CLI::FormatterBase {
public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

} // namespace wavepath
