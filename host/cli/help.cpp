// The layout of --help.
#include <algorithm>
#include <memory>
#include <sstream>
#include <vector>

#include <CLI/CLI.hpp>

#include "host/cli/flags.h"

namespace wavepath {
namespace {

constexpr std::size_t kHelpWidth = 100, kMeaningColumn = 30;

// Words of `text` from column `column` on, lines broken at kHelpWidth. The cursor stands at `used`.
std::string wrap(const std::string& text, std::size_t column, std::size_t used) {
  std::string out;
  if (used > 0 && used + 2 > column) {
    out += '\n';
    used = 0;
  }
  out.append(column - used, ' ');
  std::size_t position = column;
  std::istringstream words(text);
  for (std::string word; words >> word; position += word.size()) {
    if (position > column && position + 1 + word.size() > kHelpWidth) {
      out += '\n' + std::string(column, ' ');
      position = column;
    } else if (position > column) {
      out += ' ';
      ++position;
    }
    out += word;
  }
  return out + '\n';
}

std::string line(const CLI::Option& option) {
  std::string names = option.get_positional() ? option.get_name(true) : "";
  if (!option.get_positional()) {
    for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
    if (names.empty()) names = "    "; // so that long names line up
    for (const std::string& name : option.get_lnames())
      names += (names == "    " || names.empty() ? "--" : ", --") + name;
    if (option.get_expected_max() > 0) names += " " + option.get_type_name();
  }
  names = "  " + names;
  const std::string initial = option.get_default_str();
  return names + wrap(option.get_description() + (initial.empty() ? "" : " [default: " + initial + "]"), kMeaningColumn,
                      names.size());
}

class HelpLayout : public CLI::FormatterBase {
public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

std::string HelpLayout::make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const {
  const std::string title = (app->get_parent() ? app->get_parent()->get_name() + " " : "") + app->get_name();
  std::string out = wrap(title + ": " + app->get_description(), 0, 0) + "\nUsage: " + title;
  const auto commands = app->get_subcommands([](const CLI::App*) { return true; });
  if (!commands.empty()) out += " COMMAND";
  for (const CLI::Option* option : app->get_options())
    if (option->get_positional())
      out += option->get_required() ? " " + option->get_name(true) : " [" + option->get_name(true) + "]";
  out += " [flags]\n";

  if (!commands.empty()) out += "\nCommands\n";
  for (const CLI::App* command : commands)
    out +=
        "  " + command->get_name() + wrap(command->get_description(), kMeaningColumn, command->get_name().size() + 2);

  // The parser lists its own --help first; it belongs last.
  std::vector<std::string> groups = app->get_groups();
  std::stable_partition(groups.begin(), groups.end(), [](const std::string& group) { return group != kHelpGroup; });
  for (const std::string& group : groups) {
    const auto members = app->get_options([&](const CLI::Option* option) { return option->get_group() == group; });
    if (members.empty()) continue;
    out += "\n" + group + "\n";
    for (const CLI::Option* option : members) out += line(*option);
  }
  return out + (app->get_footer().empty() ? "" : "\n" + wrap(app->get_footer(), 0, 0));
}

} // namespace

void set_help_layout(CLI::App& app) { app.formatter(std::make_shared<HelpLayout>()); }

} // namespace wavepath
