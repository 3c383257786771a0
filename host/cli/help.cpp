// The layout of --help and --help-all.
#include <algorithm>
#include <memory>
#include <set>
#include <sstream>
#include <vector>

#include <fmt/format.h>
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
  void leave_out(const CLI::Option* flag) { left_out_.insert(flag); }

private:
  using Flags = std::vector<const CLI::Option*>;
  std::size_t left_out_of(const CLI::App& app) const;
  Flags flags_of(const CLI::App& app, const std::string& group, bool all) const;
  std::string other_help(const CLI::App& app, const std::string& title, bool all) const;

  std::set<const CLI::Option*> left_out_; // by --help of their commands
};

std::size_t HelpLayout::left_out_of(const CLI::App& app) const {
  return app.get_options([&](const CLI::Option* option) { return left_out_.contains(option); }).size();
}

HelpLayout::Flags HelpLayout::flags_of(const CLI::App& app, const std::string& group, bool all) const {
  const bool has_more = left_out_of(app) > 0; // else --help-all is no other than --help
  return app.get_options([&](const CLI::Option* option) {
    if (option == app.get_help_all_ptr() && !has_more) return false;
    return option->get_group() == group && (all || !left_out_.contains(option));
  });
}

// How to get the other one of --help and --help-all, where they differ.
std::string HelpLayout::other_help(const CLI::App& app, const std::string& title, bool all) const {
  const std::size_t count = left_out_of(app);
  if (count == 0) return "";
  const std::string text = all ? fmt::format("These are all flags. '{} --help' shows the usual ones alone.", title)
                               : fmt::format("'{} --help-all' shows {} more flags, for experts.", title, count);
  return "\n" + wrap(text, 0, 0);
}

std::string HelpLayout::make_help(const CLI::App* app, std::string, CLI::AppFormatMode mode) const {
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

  const bool all = mode == CLI::AppFormatMode::All;
  // Groups that --help leaves out come after the others, and the parser's own flags, which it lists first, at the end.
  const auto rank = [&](const std::string& group) {
    return group == kHelpGroup ? 2 : flags_of(*app, group, false).empty() ? 1 : 0;
  };
  std::vector<std::string> groups = app->get_groups();
  std::ranges::stable_sort(groups, {}, rank);
  for (const std::string& group : groups) {
    const Flags members = flags_of(*app, group, all);
    if (members.empty()) continue;
    out += "\n" + group + "\n";
    for (const CLI::Option* option : members) out += line(*option);
  }
  out += other_help(*app, title, all);
  return out + (app->get_footer().empty() ? "" : "\n" + wrap(app->get_footer(), 0, 0));
}

} // namespace

void leave_out_of_help(const CLI::App& command, const CLI::Option* flag) {
  if (auto* layout = dynamic_cast<HelpLayout*>(command.get_formatter().get())) layout->leave_out(flag);
}

void set_help_layout(CLI::App& app) { app.formatter(std::make_shared<HelpLayout>()); }

} // namespace wavepath
