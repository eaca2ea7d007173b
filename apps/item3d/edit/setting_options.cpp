#include "apps/item3d/edit/setting_options.h"

#include "apps/item3d/command.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/edit/settings_table.h"

#include <cstdint>
#include <vector>

namespace item3d {
namespace {

template <typename T>
CLI::Option* add_typed(CLI::App& command, nlohmann::json& overrides, const Setting& setting) {
    return command.add_option_function<T>(
        setting.flag,
        [&overrides, name = setting.name](const T& value) { overrides[name] = value; },
        setting.help);
}

CLI::Option* add_by_type(CLI::App& command, nlohmann::json& overrides, const Setting& setting) {
    switch (setting.type) {
        case SettingType::text:
        case SettingType::choice:
            return add_typed<std::string>(command, overrides, setting);
        case SettingType::integer:
            return add_typed<int>(command, overrides, setting);
        case SettingType::unsigned_integer:
            return add_typed<std::uint64_t>(command, overrides, setting)->check(seed_check());
        case SettingType::number:
            return add_typed<float>(command, overrides, setting);
        case SettingType::numbers:
            return add_typed<std::vector<float>>(command, overrides, setting)
                ->delimiter(',')
                ->expected(2);
        case SettingType::texts:
            return add_typed<std::vector<std::string>>(command, overrides, setting)->delimiter(',');
        case SettingType::repeated_texts:
            // Each use of the option takes one value. Otherwise the option would consume the
            // arguments after it.
            return add_typed<std::vector<std::string>>(command, overrides, setting)
                ->allow_extra_args(false);
    }
    ITEM3D_CHECK(false, "unknown type of a setting");
}

/// Returns the choices separated by vertical bars, or NAME if that text is too long.
std::string placeholder(const Setting& setting) {
    constexpr std::size_t longest = 24;
    if (setting.choices.empty()) return setting.placeholder;
    const std::string all = fmt::format("{}", fmt::join(setting.choices, "|"));
    return all.size() <= longest ? all : "NAME";
}

/// Adds the help of a setting beside its description. The value itself is checked later with all
/// other settings, once those of the prior are known.
void describe(CLI::Option& option, const Setting& setting) {
    option.group(setting.group);
    if (const std::string name = placeholder(setting); !name.empty()) option.type_name(name);
    if (const std::string value = readable(setting.get({})); value != "none")
        option.default_str(value);
    if (!setting.values.empty() && setting.choices.empty())
        option.check(CLI::Validator([](std::string&) { return std::string(); }, setting.values));
}

CLI::Option* add_row(CLI::App& command, nlohmann::json& overrides, const Setting& setting) {
    CLI::Option* option = add_by_type(command, overrides, setting);
    describe(*option, setting);
    return option;
}

}  // namespace

CLI::Option* add_setting(CLI::App& command, nlohmann::json& overrides, const std::string& name) {
    return add_row(command, overrides, setting_named(name));
}

void add_settings(CLI::App& command, nlohmann::json& overrides) {
    for (const Setting& setting : settings_table())
        if (!setting.flag.empty() && command.get_option_no_throw(setting.flag) == nullptr)
            add_row(command, overrides, setting);
}

void add_extras_options(CLI::App& command, nlohmann::json& overrides) {
    for (const char* name : {"lora", "embedding", "controlnet", "controlnet_scale", "vae"})
        add_setting(command, overrides, name);
}

}  // namespace item3d
