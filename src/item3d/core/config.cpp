#include "item3d/core/config.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"

#include <cmath>
#include <cstring>
#include <utility>

namespace item3d {
namespace {

/// Reads a JSON number without a fraction, within Config::max_integer.
bool read_integer(const nlohmann::json& value, int& result) {
    double number = 0;
    if (value.is_number_unsigned() && value.get<std::uint64_t>() > Config::max_integer)
        return false;
    if (!value.is_number()) return false;
    number = value.get<double>();
    if (!(std::abs(number) <= Config::max_integer) || number != std::floor(number)) return false;
    result = static_cast<int>(number);
    return true;
}

/// Puts infinities and NaN in quotes. Python writes them as bare words, which JSON does not allow,
/// and published configs contain them. As strings they cause an error only if their key is read.
std::string quote_python_numbers(const std::string& text) {
    std::string result;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size();) {
        if (in_string && text[i] == '\\') {
            result += text.substr(i, 2);
            i += 2;
            continue;
        }
        if (text[i] == '"') in_string = !in_string;
        std::size_t length = 0;
        for (const char* word : {"-Infinity", "Infinity", "NaN"})
            if (!in_string && length == 0 && text.compare(i, std::strlen(word), word) == 0)
                length = std::strlen(word);
        if (length > 0) {
            result += '"' + text.substr(i, length) + '"';
            i += length;
        } else {
            result += text[i++];
        }
    }
    return result;
}

}  // namespace

Config::Config(nlohmann::json values, std::string subject)
    : values_(std::move(values)), subject_(std::move(subject)) {
    if (!values_.is_object())
        throw InputError(subject_, "expected a JSON object",
                         "download the file again, or correct it");
}

Config Config::read(const std::filesystem::path& path) {
    const std::string text = read_text(path);
    nlohmann::json values = parse_json(text);
    if (values.is_discarded()) values = parse_json(quote_python_numbers(text));
    if (values.is_discarded())
        throw InputError(path.string(), "is not valid JSON",
                         "download the file again, or correct it");
    return Config(std::move(values), path.string());
}

bool Config::has(const std::string& key) const {
    const auto found = values_.find(key);
    return found != values_.end() && !found->is_null();
}

void Config::reject(const std::string& key, const std::string& problem) const {
    throw InputError(subject_, "\"" + key + "\": " + problem,
                     "download the file again, or correct it");
}

void Config::fail(const std::string& key, const std::string& wanted) const {
    std::string found = has(key) ? values_.at(key).dump(-1, ' ', true) : "nothing";
    if (found.size() > 60) found = found.substr(0, 57) + "...";
    reject(key, "expected " + wanted + ", found " + found);
}

int Config::integer(const std::string& key, int fallback) const {
    if (!has(key)) return fallback;
    int result = 0;
    if (!read_integer(values_.at(key), result)) fail(key, "an integer in the allowed range");
    return result;
}

double Config::number(const std::string& key, double fallback) const {
    if (!has(key)) return fallback;
    if (!values_.at(key).is_number()) fail(key, "a number");
    return values_.at(key).get<double>();
}

bool Config::boolean(const std::string& key, bool fallback) const {
    if (!has(key)) return fallback;
    if (!values_.at(key).is_boolean()) fail(key, "true or false");
    return values_.at(key).get<bool>();
}

std::string Config::text(const std::string& key, const std::string& fallback) const {
    if (!has(key)) return fallback;
    if (!values_.at(key).is_string()) fail(key, "a string");
    return values_.at(key).get<std::string>();
}

std::vector<int> Config::integers(const std::string& key, const std::vector<int>& fallback,
                                  std::size_t count) const {
    std::vector<int> result;
    if (!has(key)) {
        result = fallback;
    } else if (values_.at(key).is_array()) {
        for (const auto& entry : values_.at(key)) {
            int value = 0;
            if (!read_integer(entry, value)) fail(key, "integers in the allowed range");
            result.push_back(value);
        }
    } else {
        result.push_back(integer(key, 0));
    }
    if (count > 0 && result.size() == 1 && !(has(key) && values_.at(key).is_array()))
        result.assign(count, result[0]);
    if (count > 0 && result.size() != count) fail(key, std::to_string(count) + " integers");
    if (result.size() > 64) fail(key, "at most 64 integers");
    return result;
}

std::vector<double> Config::numbers(const std::string& key) const {
    std::vector<double> result;
    if (!has(key)) return result;
    if (!values_.at(key).is_array()) fail(key, "a list of numbers");
    for (const auto& entry : values_.at(key)) {
        if (!entry.is_number()) fail(key, "a list of numbers");
        result.push_back(entry.get<double>());
    }
    return result;
}

std::vector<std::string> Config::texts(const std::string& key,
                                       const std::vector<std::string>& fallback) const {
    if (!has(key)) return fallback;
    if (!values_.at(key).is_array()) fail(key, "a list of strings");
    std::vector<std::string> result;
    for (const auto& entry : values_.at(key)) {
        if (!entry.is_string()) fail(key, "a list of strings");
        result.push_back(entry.get<std::string>());
    }
    return result;
}

Config Config::part(const std::string& key) const {
    if (!has(key)) fail(key, "an object");
    return Config(values_.at(key), subject_ + ": " + key);
}

int Config::size(const std::string& key, int fallback) const {
    const int result = integer(key, fallback);
    if (result < 1) fail(key, "at least 1");
    return result;
}

std::vector<int> Config::sizes(const std::string& key, const std::vector<int>& fallback,
                               std::size_t count) const {
    std::vector<int> result = integers(key, fallback, count);
    if (result.empty()) fail(key, "at least one size");
    for (const int value : result)
        if (value < 1) fail(key, "sizes of at least 1");
    return result;
}

void Config::expect(const std::string& key, const nlohmann::json& value) const {
    if (has(key) && values_.at(key) != value)
        fail(key, value.dump() + " (no other value is supported)");
}

}  // namespace item3d
