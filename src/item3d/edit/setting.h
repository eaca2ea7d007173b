// One setting of an edit, and the functions that make the rows of the table in settings_table.cpp.
#pragma once

#include "item3d/core/parse_json.h"
#include "item3d/edit/settings.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace item3d {

/// Type of a value. On the command line, `texts` is a comma-separated list, and `repeated_texts`
/// takes one value for each use of the option.
enum class SettingType {
    text,
    choice,
    integer,
    unsigned_integer,  ///< 64 bits
    number,
    numbers,
    texts,
    repeated_texts,
};

/// Returns "text", "choice", "integer", "number", "numbers", "texts" or "repeated_texts".
const char* type_name(SettingType type);

struct Setting {
    std::string name;  ///< key in JSON, and name of EditSettings' member
    std::string flag;  ///< option of the command line; empty if there is none
    SettingType type;
    std::string values;  ///< allowed values, in words ("between 1 and 64"); empty if any is allowed
    std::string help;

    std::function<nlohmann::json(const EditSettings&)> get;
    /// Throws as from_json().
    std::function<void(EditSettings&, const nlohmann::json&)> set;
    /// Throws InputError if the value is out of range.
    std::function<void(const EditSettings&)> check;

    std::string group = {};                     ///< heading in --help
    std::vector<std::string> choices = {};      ///< the names, if the type is choice
    std::optional<double> low = {}, high = {};  ///< inclusive range of a number
    /// Name of the value in --help ("FOLDER"); if empty, it follows from the type.
    std::string placeholder = {};
};

namespace rows {

template <typename T>
constexpr SettingType type_of() {
    if constexpr (std::is_same_v<T, int>) return SettingType::integer;
    if constexpr (std::is_same_v<T, std::uint64_t>) return SettingType::unsigned_integer;
    if constexpr (std::is_same_v<T, float>) return SettingType::number;
    if constexpr (std::is_same_v<T, std::vector<float>>) return SettingType::numbers;
    if constexpr (std::is_same_v<T, std::vector<std::string>>) return SettingType::texts;
    return SettingType::text;
}

/// True if the value is not a number (its type is tested elsewhere), or is an integer of at least
/// 0.
inline bool is_whole_number(const nlohmann::json& value) {
    if (value.is_number_float()) return false;
    return !value.is_number_integer() || value.is_number_unsigned() ||
           value.get<std::int64_t>() >= 0;
}

/// Reads a value. Throws nlohmann::json::exception for a value of another type. If T is an integer
/// type, also throws for a fraction. If T is int, also throws for a number out of range.
template <typename T>
void read_value(const nlohmann::json& value, T& member) {
    if constexpr (std::is_same_v<T, int>)
        member = int_of(value);
    else if (std::is_same_v<T, std::uint64_t> && !is_whole_number(value))
        throw nlohmann::json::type_error::create(302, "expected a whole number", nullptr);
    else
        value.get_to(member);
}

/// Makes a setting, which is one row of the table. Owner: EditSettings or a base class of it.
template <typename T, typename Owner>
Setting setting(const char* name, T Owner::*member, const char* flag, const std::string& help) {
    return {name,
            flag,
            type_of<T>(),
            "",
            help,
            [member](const EditSettings& settings) -> nlohmann::json { return settings.*member; },
            [member](EditSettings& settings, const nlohmann::json& value) {
                read_value(value, settings.*member);
            },
            [](const EditSettings&) {}};
}

/// Restricts a setting to values for which `fits` is true. The error message says that it "must be
/// `values`".
Setting restricted(Setting setting, const std::string& values,
                   std::function<bool(const EditSettings&)> fits);

/// Range of a number, ends included.
struct Limits {
    double low, high;
    std::string words;  ///< text after "must be"
};
Limits between(double low, double high);
Limits between(double low, double high, const std::string& words);
Limits at_least(double low);
Limits above_zero(double high);

/// Restricts a number to a range.
Setting limited(Setting setting, const Limits& limits,
                std::function<double(const EditSettings&)> value);

template <typename T, typename Owner>
Setting setting(const char* name, T Owner::*member, const Limits& limits, const char* flag,
                const std::string& help) {
    return limited(
        setting(name, member, flag, help), limits,
        [member](const EditSettings& settings) { return static_cast<double>(settings.*member); });
}

/// Returns "a, b or c".
std::string alternatives(const std::vector<std::string>& names);

/// Returns the index of `text` in `names`. Throws InputError that names the flag and the choices.
std::size_t find_choice(const std::string& flag, const std::vector<std::string>& names,
                        const std::string& text);

/// Makes a setting of type choice. names: the names of the enumeration's values, in order; parse:
/// returns the value of a name, or throws InputError.
template <typename Enum>
Setting choice(const char* name, Enum EditSettings::*member, const std::vector<std::string>& names,
               std::function<Enum(const std::string&)> parse, const char* flag,
               const std::string& help) {
    return {name,
            flag,
            SettingType::choice,
            alternatives(names),
            help,
            [member, names](const EditSettings& settings) -> nlohmann::json {
                return names.at(static_cast<std::size_t>(settings.*member));
            },
            [member, parse](EditSettings& settings, const nlohmann::json& value) {
                settings.*member = parse(value.get<std::string>());
            },
            [](const EditSettings&) {},
            "",
            names};
}

template <typename Enum>
Setting choice(const char* name, Enum EditSettings::*member, const std::vector<std::string>& names,
               const char* flag, const std::string& help) {
    const std::function<Enum(const std::string&)> parse =
        [names, flag = std::string(flag)](const std::string& text) {
            return static_cast<Enum>(find_choice(flag, names, text));
        };
    return choice(name, member, names, parse, flag, help);
}

/// Makes a list setting whose option is repeated and has one element each time.
Setting repeated(Setting setting);

/// Sets the name of the value in --help.
Setting with_placeholder(const char* placeholder, Setting setting);

}  // namespace rows
}  // namespace item3d
