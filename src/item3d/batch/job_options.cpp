#include "item3d/batch/job_options.h"

#include "item3d/core/error.h"
#include "item3d/core/parse_json.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::vector<std::string> file_options = {
    "captioner",  "clip",      "controlnet", "embedding", "exclude", "from-light",
    "inpainting", "instruct",  "light",      "lora",      "plan",    "prior",
    "region",     "segmenter", "teacher",    "textures",  "vae"};

/// Range of a path within a value.
struct Part {
    std::size_t begin, size;
};

std::vector<Part> possible_paths(const std::string& value) {
    std::vector<Part> parts = {{0, value.size()}};
    if (const std::size_t colon = value.rfind(':'); colon != std::string::npos && colon > 0)
        parts.push_back({0, colon});
    if (const std::size_t sign = value.find('='); sign != std::string::npos)
        parts.push_back({sign + 1, value.size() - sign - 1});
    return parts;
}

/// Returns the part of the value that is an existing path relative to `folder`; a part of size 0 if
/// there is none.
Part path_in(const std::string& value, const fs::path& folder) {
    std::error_code code;
    for (const Part& part : possible_paths(value))
        if (part.size > 0 && fs::exists(folder / value.substr(part.begin, part.size), code))
            return part;
    return {0, 0};
}

std::string value_text(const json& value, const std::string& option, const std::string& subject) {
    if (is_argument(value)) return value.get<std::string>();
    if (value.is_number() || value.is_boolean()) return value.dump();
    throw InputError(subject, option + " cannot be " + value.dump(),
                     "expected a string, a number or a list of them");
}

/// Returns a field as a list; a list in a CSV field is written as JSON.
json as_list(const json& value) {
    if (value.is_array()) return value;
    if (value.is_string() && value.get_ref<const std::string&>().starts_with('[')) {
        json list = parse_json(value.get<std::string>());
        if (list.is_array()) return list;
    }
    return json::array({value});
}

bool is_true(const json& value, const std::string& option, const std::string& subject) {
    if (value == json(true) || value == json("true") || value == json("yes") || value == json(1) ||
        value == json("1"))
        return true;
    if (value == json(false) || value == json("false") || value == json("no") || value == json(0) ||
        value == json("0"))
        return false;
    throw InputError(subject, option + " cannot be " + value.dump(), "expected true or false");
}

}  // namespace

bool is_argument(const json& value) {
    return value.is_string() && value.get_ref<const std::string&>().find('\0') == std::string::npos;
}

bool may_name_a_file(const std::string& option) {
    return std::find(file_options.begin(), file_options.end(), option) != file_options.end();
}

std::string with_absolute_path(const std::string& option, const std::string& value,
                               const fs::path& folder) {
    if (!may_name_a_file(option)) return value;
    const Part part = path_in(value, folder);
    if (part.size == 0) return value;
    const fs::path path = (folder / value.substr(part.begin, part.size)).lexically_normal();
    return value.substr(0, part.begin) + path.string() + value.substr(part.begin + part.size);
}

JobOptions job_options(const json& values, const JobCommand& command, const fs::path& folder,
                       const std::string& subject, ContentHashes& hashes) {
    JobOptions options;
    const auto add = [&](const std::string& flag, const std::string& value) {
        options.arguments.insert(options.arguments.end(), {flag, value});
    };
    for (const auto& [option, value] : values.items()) {
        const std::string flag = "--" + option;
        const ColumnKind kind = command.options.at(option);
        if (option ==
            "prior") {  // its weights are hashed separately, and other files beside them are not
            add(flag, with_absolute_path(option, value_text(value, option, subject), folder));
            continue;
        }
        options.identity += flag + '\0';
        if (kind == ColumnKind::flag) {
            if (!is_true(value, option, subject)) continue;
            options.arguments.push_back(flag);
            options.identity += "true" + std::string(1, '\0');
            continue;
        }
        const json list = kind == ColumnKind::single ? json::array({value}) : as_list(value);
        std::string together;
        for (const json& one : list) {
            const std::string text = value_text(one, option, subject);
            const std::string absolute = with_absolute_path(option, text, folder);
            const Part path = may_name_a_file(option) ? path_in(absolute, "/") : Part{0, 0};
            options.identity += path.size == 0
                                    ? text
                                    : absolute.substr(0, path.begin) +
                                          hashes.of(absolute.substr(path.begin, path.size)) +
                                          absolute.substr(path.begin + path.size);
            options.identity += '\0';
            if (kind != ColumnKind::commas) add(flag, absolute);
            together += (together.empty() ? "" : ",") + absolute;
        }
        if (kind == ColumnKind::commas) add(flag, together);
    }
    return options;
}

}  // namespace item3d
