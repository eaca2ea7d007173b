#include "item3d/edit/setting.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <algorithm>
#include <limits>

namespace item3d {

const char* type_name(SettingType type) {
    switch (type) {
        case SettingType::text:
            return "text";
        case SettingType::choice:
            return "choice";
        case SettingType::integer:
        case SettingType::unsigned_integer:
            return "integer";
        case SettingType::number:
            return "number";
        case SettingType::numbers:
            return "numbers";
        case SettingType::texts:
            return "texts";
        case SettingType::repeated_texts:
            return "repeated_texts";
    }
    ITEM3D_CHECK(false, "unknown type of a setting");
}

namespace rows {

Setting restricted(Setting setting, const std::string& values,
                   std::function<bool(const EditSettings&)> fits) {
    const std::string subject = setting.flag.empty() ? setting.name : setting.flag;
    setting.values = values;
    setting.check = [subject, values, fits = std::move(fits)](const EditSettings& settings) {
        if (!fits(settings)) throw InputError(subject, "must be " + values);
    };
    return setting;
}

Setting limited(Setting setting, const Limits& limits,
                std::function<double(const EditSettings&)> value) {
    Setting row =
        restricted(std::move(setting), limits.words,
                   [limits, value = std::move(value)](const EditSettings& settings) {
                       return value(settings) >= limits.low && value(settings) <= limits.high;
                   });
    row.low = limits.low;
    if (limits.high < std::numeric_limits<double>::infinity()) row.high = limits.high;
    return row;
}

Limits between(double low, double high) {
    return between(low, high, fmt::format("between {:g} and {:g}", low, high));
}

Limits between(double low, double high, const std::string& words) {
    return {low, high, words};
}

Limits at_least(double low) {
    return {low, std::numeric_limits<double>::infinity(), fmt::format("{:g} or more", low)};
}

Limits above_zero(double high) {
    return {std::numeric_limits<float>::denorm_min(), high,
            fmt::format("above 0 and at most {:g}", high)};
}

std::string alternatives(const std::vector<std::string>& names) {
    return fmt::format("{} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

std::size_t find_choice(const std::string& flag, const std::vector<std::string>& names,
                        const std::string& text) {
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end()) throw InputError(flag, "must be " + alternatives(names));
    return static_cast<std::size_t>(found - names.begin());
}

Setting repeated(Setting setting) {
    setting.type = SettingType::repeated_texts;
    return setting;
}

Setting with_placeholder(const char* placeholder, Setting setting) {
    setting.placeholder = placeholder;
    return setting;
}

}  // namespace rows
}  // namespace item3d
