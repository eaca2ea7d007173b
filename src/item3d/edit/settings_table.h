// The settings of an edit, one row each: JSON, the checks, the command line's options and
// docs/reference/settings.md come from here.
#pragma once

#include "item3d/edit/settings.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <string>
#include <vector>

namespace item3d {

/// What a value is. The command line takes a list's values with commas between them, or one each
/// time that the option is given.
enum class SettingType {
    text,
    choice,
    integer,
    seed,  ///< an integer of 64 bits without a sign
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
};

/// In the order of `item3d edit --help`.
const std::vector<Setting>& settings_table();

/// Throws std::logic_error where there is none.
const Setting& setting_named(const std::string& name);

/// A value as people write it: 0.06 and not all digits of the nearest float, lists without
/// brackets, "none" for what is empty.
std::string readable(const nlohmann::json& value);

/// The content of docs/reference/settings.md.
std::string settings_markdown();

}  // namespace item3d
