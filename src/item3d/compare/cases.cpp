#include "item3d/compare/cases.h"

#include "item3d/compare/case_file.h"
#include "item3d/compare/option_values.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
#include "item3d/edit/settings_table.h"

#include <algorithm>
#include <map>
#include <set>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* case_example =
    R"(as in [{"model": "mug.glb", "from": "a red mug", "to": "a golden mug"}])";

/// Options of `item3d edit` that are not settings and that a case may have. Their value is a
/// string; `textures` may also have a list.
const std::vector<std::string> text_options = {"clip",      "captioner", "inpainting", "instruct",
                                               "teacher",   "segmenter", "textures",   "variant",
                                               "precision", "memory",    "device"};
const std::vector<std::string> other_options = {"image-size", "allow-missing-textures"};
/// Columns that are not options of an edit.
const std::vector<std::string> case_columns = {"name", "model", "from", "to", "expect"};
/// Settings that the comparison itself sets.
const std::vector<std::string> own_options = {"method", "seed"};

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> known_columns() {
    std::vector<std::string> names = case_columns;
    for (const Setting& setting : settings_table()) {
        if (setting.flag.empty()) continue;
        const std::string flag = setting.flag.substr(2);
        if (!has(own_options, flag) && !has(names, flag)) names.push_back(flag);
    }
    for (const auto& options : {text_options, other_options})
        for (const std::string& option : options)
            if (!has(names, option)) names.push_back(option);
    return names;
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& known) {
    const std::string similar = similar_name(name, known);
    return similar.empty() ? "" : "did you mean '" + similar + "'? ";
}

std::string with_dashes(std::string name) {
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

/// Returns the name by which the program knows a column. Throws InputError.
std::string column_named(const std::string& given, const std::string& subject) {
    const std::string name = with_dashes(given);
    static const std::vector<std::string> known = known_columns();
    if (has(known, name)) return name;
    if (has(own_options, name))
        throw InputError(subject, "'" + name + "' is set by the comparison",
                         "give --" + name + "s to item3d compare");
    throw InputError(subject, "unknown column '" + given + "'",
                     did_you_mean(name, known) +
                         "Columns are name, model, from, to, expect, and the options that `item3d "
                         "edit --help` lists");
}

/// Returns the option of "NAME=VALUE". Throws UsageError.
std::string option_named(const std::string& with) {
    const std::string subject = "--with " + with;
    const std::size_t split = with.find('=');
    if (split == std::string::npos || split == 0)
        throw UsageError(subject + ": expected NAME=VALUE, as in iterations=100");
    const std::string name = with_dashes(with.substr(0, split));
    if (has(case_columns, name))
        throw UsageError(subject + ": set this in the cases; it cannot be set for all of them");
    if (has(own_options, name))
        throw UsageError(fmt::format("{}: give --{}s instead", subject, name));
    std::vector<std::string> options = known_columns();
    std::erase_if(options, [](const std::string& one) { return has(case_columns, one); });
    if (!has(options, name))
        throw UsageError(fmt::format("{}: unknown option '{}'; {}`item3d edit --help` lists them",
                                     subject, with.substr(0, split), did_you_mean(name, options)));
    return name;
}

bool is_empty(const Json& value) {
    return value.is_null() || (value.is_string() && value.get<std::string>().find_first_not_of(
                                                        " \t") == std::string::npos);
}

CompareCase case_of(const Json& entry, const fs::path& file, const std::string& subject) {
    if (!entry.is_object()) throw InputError(subject, "expected an object", case_example);
    CompareCase result;
    const auto text = [&](const std::string& column, const Json& value) {
        if (!value.is_string())
            throw InputError(subject, column + " cannot be " + value.dump(), "expected a string");
        return value.get<std::string>();
    };
    const auto check_texts = [&](const std::string& column, const Json& value) {
        if (column != "textures" || !value.is_array()) text(column, value);
        if (!value.is_array()) return;
        for (const Json& one : value)
            text(column, one);
    };
    for (const auto& [given, value] : entry.items()) {
        const std::string column = column_named(given, subject);
        if (is_empty(value)) continue;
        if (value.is_object())
            throw InputError(subject, column + " cannot be " + value.dump(), case_example);
        if (column == "name")
            result.name = text(column, value);
        else if (column == "model") {
            result.given_model = text(column, value);
            result.model = file.parent_path() / result.given_model;
        } else if (column == "from")
            result.from = text(column, value);
        else if (column == "to")
            result.to = text(column, value);
        else if (column == "expect")
            result.expect = text(column, value);
        else {
            if (has(text_options, column)) check_texts(column, value);
            result.options[column] = value;
        }
    }
    if (result.model.empty()) throw InputError(subject, "has no model", case_example);
    if (result.from.empty() || result.to.empty())
        throw InputError(subject,
                         "has no '" + std::string(result.from.empty() ? "from" : "to") + "'",
                         case_example);
    if (!fs::is_regular_file(result.model))
        throw InputError(subject, "no such model: " + result.model.string(),
                         "paths are relative to the folder of " + file.filename().string());
    return result;
}

bool same_edit(const CompareCase& a, const CompareCase& b) {
    return a.model == b.model && a.from == b.from && a.to == b.to && a.options == b.options;
}

/// Gives each unnamed case a different name. Throws InputError if two cases have one name, or if
/// two unnamed cases are the same edit.
void name_cases(std::vector<CompareCase>& cases, const std::string& subject) {
    std::map<std::string, std::size_t> named;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        if (cases[i].name.empty()) continue;
        const auto [first, is_new] = named.emplace(cases[i].name, i);
        if (!is_new)
            throw InputError(subject,
                             fmt::format("cases {} and {} are both named '{}'", first->second + 1,
                                         i + 1, cases[i].name),
                             "give each case its own name");
    }
    std::vector<std::size_t> unnamed;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        if (!cases[i].name.empty()) continue;
        for (const std::size_t other : unnamed)
            if (same_edit(cases[other], cases[i]))
                throw InputError(subject,
                                 fmt::format("cases {} and {} are the same", other + 1, i + 1),
                                 "leave one of them out");
        unnamed.push_back(i);
    }
    for (const std::size_t i : unnamed) {
        const std::string base = cases[i].model.stem().string() + ": " + cases[i].to;
        std::string name = base;
        for (int count = 2; !named.emplace(name, i).second; ++count)
            name = fmt::format("{} ({})", base, count);
        cases[i].name = name;
    }
}

std::string plain(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

/// True if the option takes several values separated by commas.
bool takes_commas(const std::string& option) {
    for (const Setting& setting : settings_table())
        if (setting.flag == "--" + option)
            return setting.type == SettingType::numbers || setting.type == SettingType::texts;
    return false;
}

}  // namespace

std::vector<CompareCase> read_compare_cases(const fs::path& file) {
    const std::string subject = file.string();
    std::vector<CompareCase> cases;
    for (const Json& entry : read_case_entries(file))
        cases.push_back(
            case_of(entry, file, fmt::format("{}: case {}", subject, cases.size() + 1)));
    name_cases(cases, subject);
    return cases;
}

void set_defaults(std::vector<CompareCase>& cases, const std::vector<std::string>& options) {
    std::set<std::string> seen;
    for (const std::string& option : options) {
        const std::string name = option_named(option);
        if (!seen.insert(name).second)
            throw UsageError("--with " + option + ": '" + name + "' is given twice");
        const Json value = option.substr(option.find('=') + 1);
        check_option(name, value, "--with " + option);
        for (CompareCase& test : cases)
            if (!test.options.contains(name)) test.options[name] = value;
    }
}

std::vector<std::string> option_arguments(const Json& options) {
    std::vector<std::string> arguments;
    for (const auto& [name, value] : options.items()) {
        const std::string flag = "--" + name;
        if (name == "allow-missing-textures") {
            if (value == Json(true) || plain(value) == "true") arguments.push_back(flag);
            continue;
        }
        if (!value.is_array()) {
            arguments.insert(arguments.end(), {flag, plain(value)});
            continue;
        }
        std::string together;
        for (const Json& one : value) {
            if (!takes_commas(name)) arguments.insert(arguments.end(), {flag, plain(one)});
            together += (together.empty() ? "" : ",") + plain(one);
        }
        if (takes_commas(name)) arguments.insert(arguments.end(), {flag, together});
    }
    return arguments;
}

}  // namespace item3d
