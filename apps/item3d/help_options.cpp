// Conversion of CLI11's options to display texts.
#include "apps/item3d/help.h"

#include <algorithm>
#include <cctype>

namespace item3d {
namespace {

/// Maximum length of choices in the value column; longer lists go into the description.
constexpr std::size_t longest_choices = 64;

std::string joined(const std::vector<std::string>& parts, const std::string& separator) {
    std::string all;
    for (const std::string& part : parts)
        all += (all.empty() ? "" : separator) + part;
    return all;
}

bool is_range(const std::string& text) {
    return text.find('[') != std::string::npos && text.find(" - ") != std::string::npos &&
           text.back() == ']';
}

/// Returns "16 to 2048" for "INT in [16 - 2048]".
std::string range_of(const std::string& text) {
    const std::size_t begin = text.find('[') + 1, middle = text.find(" - ");
    return text.substr(begin, middle - begin) + " to " +
           text.substr(middle + 3, text.size() - middle - 4);
}

/// Returns the choices of "{png,exr}" separated by a vertical bar.
std::string choices_of(std::string text) {
    text = text.substr(1, text.size() - 2);
    std::replace(text.begin(), text.end(), ',', '|');
    return text;
}

std::string placeholder(const std::string& type) {
    if (type == "INT" || type == "UINT") return "N";
    if (type == "FLOAT") return "X";
    return type;
}

/// The type of a value and its constraint, which CLI11 writes as "TEXT:{png,exr}".
struct ValueText {
    std::string value, constraint;
};

ValueText value_text(const CLI::Option& option) {
    if (option.get_items_expected_max() == 0) return {};
    const std::string type = option.get_type_name();
    const std::size_t colon = std::min(type.find(':'), type.size());
    ValueText text = {placeholder(type.substr(0, colon)), ""};
    const std::string check = colon < type.size() ? type.substr(colon + 1) : "";
    if (check.empty()) return text;
    if (check.front() == '{' && check.size() <= longest_choices)
        text.value = choices_of(check);
    else if (check.front() == '{')
        text.constraint = "one of " + check.substr(1, check.size() - 2);
    else if (is_range(check))
        text.constraint = range_of(check);
    else if (check == "POSITIVE")
        text.constraint = "above 0";
    else if (check == "NONNEGATIVE")
        text.constraint = "0 or more";
    else
        text.constraint = check;
    return text;
}

std::string names_of(const CLI::Option& option) {
    if (option.get_positional()) return option.get_name(true);
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames())
        names.push_back("-" + name);
    for (const std::string& name : option.get_lnames())
        names.push_back("--" + name);
    return joined(names, ", ");
}

std::string description_of(const CLI::Option& option, const std::string& constraint) {
    std::vector<std::string> remarks;
    if (!constraint.empty()) remarks.push_back(constraint);
    const std::string standard = option.get_default_str();
    if (!standard.empty() && standard != "{}" && standard != "[]")
        remarks.push_back("default " + standard);
    for (const CLI::Option* needed : option.get_needs())
        remarks.push_back("needs " + needed->get_name());
    for (const CLI::Option* excluded : option.get_excludes())
        remarks.push_back("not with " + excluded->get_name(excluded->get_positional()));
    const std::string text = option.get_description();
    return remarks.empty() ? text : text + " (" + joined(remarks, "; ") + ")";
}

bool is_on_first_screen(const CommandHelp& help, const CLI::Option& option) {
    if (help.first_screen.empty() || option.get_required() || option.get_positional()) return true;
    for (const std::string& name : option.get_lnames())
        if (name == "help" || name == "help-all" ||
            std::find(help.first_screen.begin(), help.first_screen.end(), name) !=
                help.first_screen.end())
            return true;
    return false;
}

}  // namespace

std::vector<OptionText> option_texts(const CLI::App& command) {
    const CommandHelp& help = help_of(command);
    std::vector<OptionText> texts;
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group().empty()) continue;
        const ValueText value = value_text(*option);
        OptionText text;
        text.names = names_of(*option);
        text.value = option->get_positional() ? "" : value.value;
        text.description = description_of(*option, value.constraint);
        text.group = option->get_group();
        text.required = option->get_required();
        text.positional = option->get_positional();
        text.first_screen = is_on_first_screen(help, *option);
        text.repeated = option->get_expected_max() > 1 && option->get_delimiter() == '\0';
        texts.push_back(std::move(text));
    }
    return texts;
}

std::string usage_line(const CLI::App& command) {
    std::string line = full_name(command);
    if (const std::string& usage = help_of(command).usage; !usage.empty())
        return line + " " + usage;
    bool has_others = false;
    for (const OptionText& option : option_texts(command)) {
        if (option.positional)
            line += " " + (option.required ? option.names : "[" + option.names + "]") +
                    (option.repeated ? "..." : "");
        else if (option.required)
            line += " " + option.names.substr(0, option.names.find(',')) + " " + option.value;
        else
            has_others = true;
    }
    if (has_others) line += " [OPTIONS]";
    if (!command.get_subcommands({}).empty())
        line += command.get_require_subcommand_min() > 0 ? " COMMAND" : " [COMMAND]";
    return line;
}

}  // namespace item3d
