#include "item3d/compare/cases.h"

#include "item3d/core/csv.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/json_text.h"
#include "item3d/core/names.h"
#include "item3d/edit/settings_table.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* case_example =
    R"(as in [{"model": "mug.glb", "from": "a red mug", "to": "a golden mug"}])";

/// Options of `item3d edit` that are not settings and that a case may have: one string each, for
/// textures also a list.
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

/// Returns the program's name of a column. Throws InputError.
std::string column_named(std::string name, const std::string& subject) {
    std::replace(name.begin(), name.end(), '_', '-');
    static const std::vector<std::string> known = known_columns();
    if (has(known, name)) return name;
    if (has(own_options, name))
        throw InputError(subject, "'" + name + "' is set by the comparison",
                         "give --" + name + "s to item3d compare");
    throw InputError(subject, "unknown column '" + name + "'",
                     "did you mean '" + nearest_name(name, known) +
                         "'? Columns are model, from, to, instruction and what item3d edit --help "
                         "lists");
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
        else if (column == "model")
            result.model = file.parent_path() / text(column, value);
        else if (column == "from")
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
    if (result.name.empty()) result.name = result.model.stem().string() + ": " + result.to;
    return result;
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
    const std::string text = read_text(file);
    const std::string subject = file.string();
    Json entries;
    if (file.extension() == ".csv") {
        entries = csv_objects(parse_csv(text, subject), subject + ": case");
    } else {
        entries = parse_json(text);
        if (entries.is_discarded())
            throw InputError(subject, "is not valid JSON",
                             "expected a list of cases, or a file that ends in .csv");
    }
    if (!entries.is_array() || entries.empty())
        throw InputError(subject, "expected a list of cases", case_example);
    std::vector<CompareCase> cases;
    for (const Json& entry : entries)
        cases.push_back(
            case_of(entry, file, fmt::format("{}: case {}", subject, cases.size() + 1)));
    return cases;
}

void set_option(std::vector<CompareCase>& cases, const std::string& option) {
    const std::size_t split = option.find('=');
    if (split == std::string::npos || split == 0)
        throw UsageError("--with " + option + ": expected NAME=VALUE, as in iterations=100");
    const std::string name = column_named(option.substr(0, split), "--with");
    if (has(case_columns, name))
        throw UsageError("--with " + option +
                         ": set this in the cases; it cannot be set for all of them");
    for (CompareCase& test : cases)
        test.options[name] = option.substr(split + 1);
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
