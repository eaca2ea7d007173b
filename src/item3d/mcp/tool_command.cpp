#include "item3d/mcp/tool_command.h"

#include "item3d/core/error.h"
#include "item3d/core/names.h"
#include "item3d/lighting/environment.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string option_name(std::string_view argument) {
    std::string name(argument);
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

std::string_view json_type(ArgumentKind kind) {
    switch (kind) {
        case ArgumentKind::number:
            return "number";
        case ArgumentKind::integer:
            return "integer";
        case ArgumentKind::settings:
            return "object";
        case ArgumentKind::selectors:
        case ArgumentKind::texts:
        case ArgumentKind::folders:
            return "array";
        case ArgumentKind::text:
        case ArgumentKind::file:
        case ArgumentKind::checkpoint:
        case ArgumentKind::light:
            return "string";
    }
    return "string";
}

bool is_of_type(const json& value, std::string_view type) {
    if (type == "number") return value.is_number();
    if (type == "integer") return value.is_number_integer();
    if (type == "object") return value.is_object();
    if (type == "string") return value.is_string();
    return value.is_array() && std::all_of(value.begin(), value.end(),
                                           [](const json& entry) { return entry.is_string(); });
}

std::string text_of(const json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Builder of a command line. Joins several strings of one option by commas. Files must lie in the
/// allowed folders.
class CommandBuilder {
  public:
    CommandBuilder(const AllowedFolders& folders, const json& settings)
        : folders_(folders), settings_(settings) {}

    void add(const ToolArgument& argument, const json& value) {
        const std::string name(argument.name);
        if (!is_of_type(value, json_type(argument.kind)))
            throw InputError(name, "expected " + std::string(json_type(argument.kind)) +
                                       ", found " + value.dump());
        if (argument.kind == ArgumentKind::settings) return add_settings(value);
        for (const json& each : value.is_array() ? value : json::array({value})) {
            const std::string text = checked(argument.kind, name, text_of(each));
            if (argument.is_positional)
                positional_.push_back(text);
            else
                add_option(option_name(name), text);
        }
    }

    void add_option(const std::string& name, const std::string& text) {
        options_.push_back("--" + name + "=" + text);
    }

    std::vector<std::string> arguments(std::string_view command) const {
        std::vector<std::string> all{std::string(command)};
        all.insert(all.end(), options_.begin(), options_.end());
        all.push_back("--");
        all.insert(all.end(), positional_.begin(), positional_.end());
        return all;
    }

  private:
    std::string checked(ArgumentKind kind, const std::string& name, const std::string& text) const {
        if (text.find('\0') != std::string::npos)
            throw InputError(name, "contains a null character");
        switch (kind) {
            case ArgumentKind::file:
            case ArgumentKind::checkpoint:
            case ArgumentKind::folders:
                return folders_.existing(text, name).string();
            case ArgumentKind::light:
                return light(text);
            case ArgumentKind::selectors:
                return selector(text);
            default:
                return text;
        }
    }

    std::string light(const std::string& text) const {
        if (is_light_preset(text)) return text;
        return folders_.existing(text, "light").string();
    }

    /// Checks the files of a selector: mask=FILE[@MATERIAL] and view=FILE[@CAMERA], where CAMERA
    /// may be a file too.
    std::string selector(const std::string& text) const {
        const std::size_t equals = text.find('=');
        const std::string kind = text.substr(0, equals);
        if (equals == std::string::npos || (kind != "mask" && kind != "view")) return text;
        const std::size_t at = text.find('@', equals);
        const std::string file = text.substr(equals + 1, at - equals - 1);
        std::string all = kind + "=" + folders_.existing(file, kind).string();
        if (at == std::string::npos) return all;
        std::string place = text.substr(at + 1);
        if (kind == "view" && place.find(".json") != std::string::npos) {
            const std::size_t frame = std::min(place.find('#'), place.size());
            place =
                folders_.existing(place.substr(0, frame), "view").string() + place.substr(frame);
        }
        return all + "@" + place;
    }

    /// Checks the files of a setting, including FILE:SCALE of a LoRA and FILE:TOKEN of an
    /// embedding.
    std::string setting(const std::string& name, const std::string& text, bool is_path) const {
        if (name == "light") return light(text);
        if (name == "region" || name == "exclude") return selector(text);
        if (!is_path) return text;
        const bool has_more = name == "lora" || name == "embedding";
        const std::size_t end = std::min(has_more ? text.rfind(':') : text.npos, text.size());
        return folders_.existing(text.substr(0, end), name).string() + text.substr(end);
    }

    void add_settings(const json& given) {
        for (const auto& [asked, value] : given.items()) {
            std::string name = asked;
            std::replace(name.begin(), name.end(), '-', '_');
            const auto row =
                std::find_if(settings_.begin(), settings_.end(),
                             [&](const json& entry) { return entry.at("name") == name; });
            if (row == settings_.end()) {
                std::vector<std::string> known;
                for (const json& entry : settings_)
                    known.push_back(entry.at("name"));
                throw InputError("settings." + asked, "item3d edit has no such option",
                                 "did you mean '" + nearest_name(name, known) + "'");
            }
            const std::string option = row->at("flag").get<std::string>().substr(2);
            const bool is_path = row->value("path", false);
            for (const json& each : value.is_array() ? value : json::array({value})) {
                if (each.is_structured() || each.is_null())
                    throw InputError("settings." + name, "cannot be " + each.dump());
                add_option(option, setting(name, text_of(each), is_path));
            }
        }
    }

    const AllowedFolders& folders_;
    const json& settings_;
    std::vector<std::string> options_, positional_;
};

}  // namespace

json description_of(const Tool& tool) {
    json properties = json::object();
    json required = json::array();
    for (const ToolArgument& argument : tool.arguments) {
        json& property = properties[std::string(argument.name)];
        property = {{"type", json_type(argument.kind)}, {"description", argument.description}};
        if (property["type"] == "array") property["items"] = {{"type", "string"}};
        if (argument.is_required) required.push_back(argument.name);
    }
    json schema = {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
    if (!required.empty()) schema["required"] = required;
    return {{"name", tool.name},
            {"title", tool.title},
            {"description", tool.description},
            {"inputSchema", schema},
            {"annotations", {{"destructiveHint", false}, {"openWorldHint", false}}}};
}

ToolCommand command_of(const Tool& tool, const json& given, const AllowedFolders& folders,
                       const json& settings) {
    for (const auto& entry : given.items()) {
        const std::string& name = entry.key();
        if (std::none_of(tool.arguments.begin(), tool.arguments.end(),
                         [&](const ToolArgument& argument) { return argument.name == name; }))
            throw InputError(name, "is not an argument of " + std::string(tool.name));
    }
    CommandBuilder builder(folders, settings);
    ToolCommand command{&tool, {}, {}};
    for (const ToolArgument& argument : tool.arguments) {
        const auto value = given.find(argument.name);
        if (value == given.end() || value->is_null()) {
            if (argument.is_required)
                throw InputError(std::string(argument.name),
                                 "is missing: " + std::string(argument.description));
            if (!argument.fallback.empty())
                builder.add_option(option_name(argument.name), std::string(argument.fallback));
        } else if (argument.kind == ArgumentKind::checkpoint) {
            command.result = folders.existing(text_of(*value), std::string(argument.name));
            builder.add_option(option_name(argument.name), "true");
        } else {
            builder.add(argument, *value);
        }
    }
    if (tool.writes() || !tool.files.empty()) {
        const std::string stem = fs::path(text_of(given.at("model"))).stem().string();
        if (command.result.empty())
            command.result = folders.make_result(std::string(tool.name) + "-" + stem);
        const bool is_file = !tool.writes();  // the result is a single file
        builder.add_option(
            "output", (is_file ? command.result / tool.files.front() : command.result).string());
    }
    command.arguments = builder.arguments(tool.command);
    return command;
}

}  // namespace item3d
