#include "apps/item3d/help.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace item3d {
namespace {

constexpr std::size_t text_column = 30;
constexpr const char* plain_group = "Options";
constexpr const char* common_group = "Common options";

class HelpFormatter final : public CLI::Formatter {
  public:
    explicit HelpFormatter(CommandHelp help) : help_(std::move(help)) {}
    const CommandHelp& help() const { return help_; }

    std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode mode) const override;

  private:
    CommandHelp help_;
};

/// Returns the width of the terminal; 100 if stdout is not a terminal.
int columns_of_stdout() {
    winsize size{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 100;
    return std::clamp<int>(size.ws_col, 60, 120);
}

/// Wraps `text`. Its first line starts at `column`, and further lines are indented to `column`.
std::string wrapped(const std::string& text, std::size_t column, int columns) {
    std::string all;
    std::size_t at = column;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        const std::size_t length = end - begin;
        if (at > column && at + 1 + length > static_cast<std::size_t>(columns)) {
            all += "\n" + std::string(column, ' ');
            at = column;
        } else if (at > column) {
            all += " ";
            ++at;
        }
        all += text.substr(begin, length);
        at += length;
        begin = end + 1;
    }
    return all + "\n";
}

std::string row(const std::string& name, const std::string& text, int columns) {
    std::string line = "  " + name;
    if (line.size() + 2 > text_column)
        line += "\n" + std::string(text_column, ' ');
    else
        line.resize(text_column, ' ');
    return line + wrapped(text, text_column, columns);
}

std::string option_row(const OptionText& option, int columns) {
    std::string name = option.names;
    if (!option.positional && name.starts_with("--")) name = "    " + name;
    if (!option.value.empty()) name += " " + option.value;
    if (option.repeated) name += "...";
    return row(name, option.description, columns);
}

/// Returns the groups of options: plain options first, then the other groups in the order of their
/// addition, and the common options last.
std::vector<std::string> groups_in_order(const std::vector<OptionText>& options) {
    std::vector<std::string> groups = {plain_group};
    for (const OptionText& option : options)
        if (std::find(groups.begin(), groups.end(), option.group) == groups.end())
            groups.push_back(option.group);
    std::stable_partition(groups.begin(), groups.end(),
                          [](const std::string& group) { return group != common_group; });
    return groups;
}

std::string options_part(const std::vector<OptionText>& options, int columns) {
    std::string text;
    for (const std::string& group : groups_in_order(options)) {
        std::string rows;
        for (const OptionText& option : options)
            if (option.group == group) rows += option_row(option, columns);
        if (!rows.empty()) text += "\n" + group + ":\n" + rows;
    }
    return text;
}

/// Returns the options of the first screen, as one group.
std::vector<OptionText> first_screen(const std::vector<OptionText>& all) {
    std::vector<OptionText> few;
    for (const OptionText& option : all) {
        if (!option.first_screen) continue;
        few.push_back(option);
        if (option.group != common_group) few.back().group = plain_group;
    }
    return few;
}

std::string commands_part(const CLI::App& command, int columns) {
    std::string text;
    for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; }))
        text += row(sub->get_name(), sub->get_description(), columns);
    return text.empty() ? "" : "\nCommands:\n" + text;
}

std::string examples_part(const CommandHelp& help) {
    std::string text;
    for (const HelpExample& example : help.examples)
        text += "  # " + example.purpose + "\n  " + example.command + "\n";
    return text.empty() ? "" : "\nExamples:\n" + text;
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string,
                                     CLI::AppFormatMode mode) const {
    return help_text(*app, mode == CLI::AppFormatMode::All, columns_of_stdout());
}

}  // namespace

void use_help(CLI::App& command, CommandHelp help) {
    command.get_help_ptr()->group(common_group)->description("Print this help and exit");
    if (!help.first_screen.empty())
        command.set_help_all_flag("--help-all", "Print all options and exit")->group(common_group);
    command.formatter(std::make_shared<HelpFormatter>(std::move(help)));
}

const CommandHelp& help_of(const CLI::App& command) {
    static const CommandHelp none;
    const auto* formatter = dynamic_cast<const HelpFormatter*>(command.get_formatter().get());
    return formatter == nullptr ? none : formatter->help();
}

std::string full_name(const CLI::App& command) {
    const CLI::App* parent = command.get_parent();
    return parent == nullptr ? command.get_name() : full_name(*parent) + " " + command.get_name();
}

std::string help_text(const CLI::App& command, bool all, int columns) {
    const CommandHelp& help = help_of(command);
    const std::vector<OptionText> options = option_texts(command);
    std::string text =
        command.get_description() + ".\n\nUsage: " + wrapped(usage_line(command), 7, columns);
    const std::vector<OptionText> shown =
        all || help.first_screen.empty() ? options : first_screen(options);
    text += options_part(shown, columns) + commands_part(command, columns);
    const std::size_t hidden = options.size() - shown.size();
    if (hidden > 0)
        text += "\n`" + full_name(command) + " --help-all` lists " + std::to_string(hidden) +
                " more options.\n";
    if (const std::string footer = command.get_footer(); !footer.empty())
        text += (footer.front() == '\n' ? "" : "\n") + footer + (footer.back() == '\n' ? "" : "\n");
    text += examples_part(help);
    if (!help.page.empty()) text += "\nMore: " + help.page + "\n";
    return text;
}

}  // namespace item3d
