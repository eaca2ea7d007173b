// One setting of an edit, and what the rows of settings_table.cpp are made with.
#pragma once

#include "item3d/core/json_text.h"
#include "item3d/edit/settings.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace item3d {

/// Type of a value. The command line takes a list separated by commas, or (repeated) one value each
/// time that the option is given.
enum class SettingType {
    text,
    choice,
    integer,
    unsigned_integer,  ///< of 64 bits
    number,
    numbers,
    texts,
    repeated_texts,
};

struct Setting {
    std::string name;  ///< in JSON, and of EditSettings' member
    std::string flag;  ///< on the command line; empty: there is none
    SettingType type;
    std::string values;  ///< what it may be, in words ("between 1 and 64"); empty: anything
    std::string help;

    std::function<nlohmann::json(const EditSettings&)> get;
    /// Throws as from_json().
    std::function<void(EditSettings&, const nlohmann::json&)> set;
    /// Throws InputError where the value is out of range.
    std::function<void(const EditSettings&)> check;

    std::string group = {};                     ///< of the settings that belong together
    std::vector<std::string> choices = {};      ///< of a choice
    std::optional<double> low = {}, high = {};  ///< ends of a number's range, themselves in it
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

/// Throws nlohmann::json::exception for a value of another type, and for a number that is no
/// integer of this one.
template <typename T>
void read_value(const nlohmann::json& value, T& member) {
    if constexpr (std::is_same_v<T, int>)
        member = int_of(value);
    else if (std::is_same_v<T, std::uint64_t> && value.is_number_float())
        throw nlohmann::json::type_error::create(302, "expected a whole number", nullptr);
    else
        value.get_to(member);
}

/// Owner: EditSettings or what it is derived from.
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

/// The setting, which "must be `values`" where it does not fit.
Setting restricted(Setting setting, const std::string& values,
                   std::function<bool(const EditSettings&)> fits);

/// Range of a number, ends included.
struct Limits {
    double low, high;
    std::string words;  ///< as behind "must be"
};
Limits between(double low, double high);
Limits between(double low, double high, const std::string& words);
Limits at_least(double low);
Limits above_zero();

/// The row with the range.
Setting limited(Setting setting, const Limits& limits,
                std::function<double(const EditSettings&)> value);

template <typename T>
Setting setting(const char* name, T EditSettings::*member, const Limits& limits, const char* flag,
                const std::string& help) {
    return limited(
        setting(name, member, flag, help), limits,
        [member](const EditSettings& settings) { return static_cast<double>(settings.*member); });
}

/// "a, b or c".
std::string alternatives(const std::vector<std::string>& names);

/// Index of `text` in `names`. Throws InputError that names flag and choices.
std::size_t find_choice(const std::string& flag, const std::vector<std::string>& names,
                        const std::string& text);

/// names: of the enumeration's values, in their order; parse: one of them, or an InputError.
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

/// A list of which the option gives one each time.
Setting repeated(Setting setting);

}  // namespace rows
}  // namespace item3d
