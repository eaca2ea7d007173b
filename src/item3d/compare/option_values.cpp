#include "item3d/compare/option_values.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/edit/settings_table.h"
#include "item3d/io/load_light.h"
#include "item3d/region/selector.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <vector>

namespace item3d {
namespace {

using Texts = std::vector<std::string>;

std::string value_text(const nlohmann::json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

Texts texts_of(const nlohmann::json& value, bool splits_at_commas) {
    if (value.is_array()) {
        Texts texts;
        for (const nlohmann::json& one : value)
            texts.push_back(value_text(one));
        return texts;
    }
    const std::string whole = value_text(value);
    if (!splits_at_commas) return {whole};
    Texts texts;
    for (std::size_t begin = 0; begin <= whole.size();) {
        const std::size_t comma = std::min(whole.find(',', begin), whole.size());
        texts.push_back(whole.substr(begin, comma - begin));
        begin = comma + 1;
    }
    return texts;
}

[[noreturn]] void refuse(const std::string& subject, const std::string& option,
                         const nlohmann::json& value, const std::string& wanted) {
    throw InputError(subject, fmt::format("{} cannot be {}", option, value.dump()),
                     "expected " + wanted);
}

int integer_value(const std::string& text, const std::string& subject, const std::string& option) {
    char* end = nullptr;
    errno = 0;
    const long long number = std::strtoll(text.c_str(), &end, 0);
    if (text.empty() || *end != '\0') refuse(subject, option, text, "a whole number");
    if (errno != 0 || number < std::numeric_limits<int>::min() ||
        number > std::numeric_limits<int>::max())
        refuse(subject, option, text, "a smaller number");
    return static_cast<int>(number);
}

float number_value(const std::string& text, const std::string& subject, const std::string& option) {
    char* end = nullptr;
    const float number = std::strtof(text.c_str(), &end);
    if (text.empty() || *end != '\0') refuse(subject, option, text, "a number");
    return number;
}

void check_folders(const std::string& option, const nlohmann::json& value,
                   const std::string& subject) {
    for (const std::string& folder : texts_of(value, false))
        if (!std::filesystem::is_directory(folder))
            throw InputError(subject, fmt::format("{}: no such folder: {}", option, folder),
                             "paths of options are relative to the working folder");
}

/// Checks that the file in FILE, FILE:SCALE or FILE:TOKEN exists.
void check_files(const std::string& option, const nlohmann::json& value,
                 const std::string& subject) {
    for (const std::string& text : texts_of(value, false))
        if (!std::filesystem::exists(text) &&
            !std::filesystem::exists(text.substr(0, text.rfind(':'))))
            throw InputError(subject, fmt::format("{}: no such file: {}", option, text),
                             "paths of options are relative to the working folder");
}

void check_selectors(const std::string& option, const nlohmann::json& value,
                     const std::string& subject) {
    Texts kinds = {"all", "auto"};
    for (const SelectorKind& kind : selector_kinds())
        kinds.push_back(kind.form.substr(0, kind.form.find('=')));
    for (const std::string& text : texts_of(value, false))
        if (std::find(kinds.begin(), kinds.end(), text.substr(0, text.find('='))) == kinds.end())
            refuse(subject, option, text,
                   fmt::format("one of {}; `item3d region --help` explains them",
                               fmt::join(kinds, ", ")));
}

void check_choice(const std::string& option, const nlohmann::json& value, const Texts& choices,
                  const std::string& subject) {
    if (std::find(choices.begin(), choices.end(), value_text(value)) == choices.end())
        refuse(subject, option, value, "one of " + fmt::format("{}", fmt::join(choices, ", ")));
}

/// Checks an option that is not a setting.
void check_other(const std::string& option, const nlohmann::json& value,
                 const std::string& subject) {
    static const Texts folders = {"clip",    "captioner", "inpainting", "instruct",
                                  "teacher", "segmenter", "textures"};
    if (std::find(folders.begin(), folders.end(), option) != folders.end()) {
        check_folders(option, value, subject);
    } else if (option == "image-size") {
        const int pixels = integer_value(value_text(value), subject, option);
        if (pixels < 16 || pixels > 2048)
            refuse(subject, option, value, "a number between 16 and 2048");
    } else if (option == "precision") {
        check_choice(option, value, precision_names(), subject);
    } else if (option == "memory") {
        check_choice(option, value, {"auto", "low", "high"}, subject);
    } else if (option == "device") {
        check_choice(option, value, {"auto", "cpu", "cuda"}, subject);
    } else if (option == "allow-missing-textures") {
        check_choice(option, value, {"true", "false"}, subject);
    }
}

}  // namespace

const Setting* setting_of_option(const std::string& option) {
    for (const Setting& setting : settings_table())
        if (setting.flag == "--" + option) return &setting;
    return nullptr;
}

nlohmann::json typed_value(const Setting& setting, const nlohmann::json& value,
                           const std::string& subject) {
    const std::string option = setting.flag.substr(std::min<std::size_t>(2, setting.flag.size()));
    const bool is_list = setting.type == SettingType::numbers ||
                         setting.type == SettingType::texts ||
                         setting.type == SettingType::repeated_texts;
    if (value.is_object() || (value.is_array() && !is_list))
        refuse(subject, option, value, "a single value");
    switch (setting.type) {
        case SettingType::text:
        case SettingType::choice:
            return value_text(value);
        case SettingType::integer:
        case SettingType::unsigned_integer:
            return integer_value(value_text(value), subject, option);
        case SettingType::number:
            return number_value(value_text(value), subject, option);
        case SettingType::numbers: {
            nlohmann::json numbers = nlohmann::json::array();
            for (const std::string& text : texts_of(value, true))
                numbers.push_back(number_value(text, subject, option));
            return numbers;
        }
        case SettingType::texts:
            return texts_of(value, true);
        case SettingType::repeated_texts:
            return texts_of(value, false);
    }
    ITEM3D_CHECK(false, "unknown type of a setting");
}

void check_option(const std::string& option, const nlohmann::json& value,
                  const std::string& subject) {
    const Setting* setting = setting_of_option(option);
    if (setting == nullptr) {
        check_other(option, value, subject);
        return;
    }
    const nlohmann::json typed = typed_value(*setting, value, subject);
    if (!setting->choices.empty()) check_choice(option, typed, setting->choices, subject);
    const bool keeps_nothing = option == "keep" && typed == nlohmann::json::array({"nothing"});
    if (!keeps_nothing) {
        EditSettings settings;
        setting->set(settings, typed);
        try {
            setting->check(settings);
        } catch (const InputError& error) {
            throw InputError(subject, fmt::format("{} cannot be {}", option, value.dump()),
                             error.what());
        }
    }
    if (option == "region" || option == "exclude") check_selectors(option, typed, subject);
    if (option == "lora" || option == "embedding") check_files(option, typed, subject);
    if (option == "controlnet" || option == "vae") check_folders(option, typed, subject);
    if (option == "light") {
        try {
            load_light(typed.get<std::string>());
        } catch (const InputError& error) {
            throw InputError(subject, error.what());
        }
    }
}

}  // namespace item3d
