#include "item3d/studio/commands.h"

#include "item3d/core/error.h"
#include "item3d/lighting/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string required_text(const Json& request, const char* key) {
    const std::string text = text_of(request, key);
    if (text.empty())
        throw InputError(key, "a sentence is missing",
                         "describe the model in a few words, as in \"a red mug\"");
    return text;
}

/// Returns a value as text for the command line: "0.5", "12", "true".
std::string value_text(const std::string& name, const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_float()) return fmt::format("{}", value.get<double>());
    if (value.is_number()) return value.dump();
    throw InputError(name, "expected a string or a number");
}

/// True if the text is a number in the setting's range, or one of its choices. Seeds have no range.
bool fits(const Json& setting, const std::string& text) {
    const std::string type = setting.at("type");
    if (const auto choices = setting.find("choices"); choices != setting.end() && type == "choice")
        return std::find(choices->begin(), choices->end(), text) != choices->end();
    if (type != "integer" && type != "number") return true;
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, number);
    if (parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(number)) return false;
    if (type == "integer" && number != std::trunc(number)) return false;
    return number >= setting.value("minimum", number) && number <= setting.value("maximum", number);
}

/// Returns the elements of a list, or the value alone.
std::vector<std::string> value_texts(const std::string& name, const Json& value) {
    std::vector<std::string> texts;
    if (!value.is_array()) return {value_text(name, value)};
    for (const Json& element : value)
        texts.push_back(value_text(name, element));
    return texts;
}

std::string option(const std::string& flag, const std::string& value) {
    return flag + "=" + value;
}

std::string quoted(const std::string& argument) {
    constexpr const char* special = " \t\n'\"\\$`&|;<>()*?[]#~!{}";
    if (!argument.empty() && argument.find_first_of(special) == std::string::npos) return argument;
    std::string text = "'";
    for (const char letter : argument)
        text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    return text + "'";
}

bool is_prior_name(const std::string& name) {
    return name.find("..") == std::string::npos && !name.starts_with('/') &&
           !name.starts_with('~') && !name.starts_with('.');
}

}  // namespace

StudioCommands::StudioCommands(const StudioFolders& folders, Json settings)
    : folders_(folders), settings_(std::move(settings)) {}

std::string light_file_name(const std::string& name) {
    return fs::path(stored_name(name + ".hdr")).stem().string() + ".hdr";
}

std::optional<std::int64_t> result_of_light(const std::string& name) {
    constexpr std::string_view prefix = "result-";
    if (!name.starts_with(prefix)) return std::nullopt;
    std::int64_t result = 0;
    const char* const end = name.data() + name.size();
    const auto parsed = std::from_chars(name.data() + prefix.size(), end, result);
    if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
    return result;
}

std::string model_path(const StudioFolders& folders, const StudioProject& project,
                       const StudioResult* parent) {
    if (!parent) return "source/" + project.file;
    const std::string folder = result_folder_name(parent->id);
    for (const char* name : {"model.glb", "model.vrm"})
        if (fs::exists(folders.project(project.id) / folder / name)) return folder + "/" + name;
    throw InputError("parent", fmt::format("result {} has no model", parent->id),
                     "choose a completed result");
}

std::string shown_command(const StudioCommand& command) {
    std::string text = "item3d";
    for (const std::string& argument : command.arguments)
        text += " " + quoted(argument);
    return text;
}

/// Returns the argument of a light: a preset, a result's light, or an uploaded light.
std::string StudioCommands::light(const StudioProject& project, const std::string& name) const {
    if (is_light_preset(name)) return name;
    if (const auto result = result_of_light(name)) {
        const std::string made = result_folder_name(*result) + "/light.hdr";
        if (fs::exists(folders_.project(project.id) / made)) return made;
    }
    const std::string file = light_file_name(name);
    if (!fs::exists(folders_.root() / "lights" / file))
        throw InputError("light", "'" + name + "' is neither a preset nor an uploaded light");
    return "../../lights/" + file;
}

void StudioCommands::add_settings(const StudioProject& project, const Json& given,
                                  Arguments& arguments) const {
    if (!given.is_object()) throw InputError("settings", "expected an object");
    for (const auto& entry : given.items()) {
        const std::string& name = entry.key();
        const Json& value = entry.value();
        if (name == "region" || name == "exclude" || name == "feather") continue;
        if (name == "prior") {
            const std::string prior = value_text(name, value);
            if (!is_prior_name(prior)) throw InputError("prior", "expected a name, not a path");
            arguments.push_back(option("--prior", prior));
            continue;
        }
        const auto row = std::find_if(settings_.begin(), settings_.end(), [&](const Json& setting) {
            return setting.at("name") == name;
        });
        if (row == settings_.end()) throw InputError(name, "unknown setting");
        if (row->value("path", false))
            throw InputError(name, "refers to a file of this machine, which the page must not use",
                             "use `item3d edit` on the command line");
        const std::string flag = row->at("flag");
        const std::string type = row->at("type");
        std::vector<std::string> texts = value_texts(name, value);
        for (const std::string& text : texts)
            if (!fits(*row, text)) {
                const std::string allowed = row->value("values", std::string());
                throw InputError(name, allowed.empty() ? "is invalid" : "must be " + allowed);
            }
        if (name == "light" && texts.size() != 1) throw InputError(name, "expected one light");
        if (name == "light") texts[0] = light(project, texts[0]);
        if (type == "repeated_texts")
            for (const std::string& text : texts)
                arguments.push_back(option(flag, text));
        else if (type == "texts" || type == "numbers")
            arguments.push_back(option(flag, fmt::format("{}", fmt::join(texts, ","))));
        else
            arguments.push_back(option(flag, texts.size() == 1 ? texts[0] : ""));
    }
    add_region(project, given, arguments);
}

void StudioCommands::add_region(const StudioProject& project, const Json& request,
                                Arguments& arguments) const {
    const auto add = [&](const char* key, const char* flag) {
        const auto selectors = request.find(key);
        if (selectors == request.end() || selectors->is_null()) return;
        for (std::string text : value_texts(key, *selectors)) {
            const std::size_t equals = text.find('=');
            const std::string kind = text.substr(0, equals);
            if (kind == "view")
                throw InputError(text, "refers to a file of this machine",
                                 "paint on the model instead");
            if (kind == "mask") {  // an uploaded mask is given by its name
                const std::size_t at = std::min(text.find('@'), text.size());
                const std::string mask = stored_name(text.substr(equals + 1, at - equals - 1));
                if (!fs::exists(folders_.project(project.id) / "masks" / mask))
                    throw InputError(text, "the project has no such mask");
                text = "mask=masks/" + mask + text.substr(at);
            }
            arguments.push_back(option(flag, text));
        }
    };
    add("region", "--region");
    add("exclude", "--exclude");
    if (const auto feather = request.find("feather");
        feather != request.end() && !feather->is_null() && *feather != 0)
        arguments.push_back(option("--feather", value_text("feather", *feather)));
}

StudioCommands::Arguments StudioCommands::edit(const StudioProject& project,
                                               const Json& request) const {
    Arguments arguments = {option("--from", required_text(request, "from")),
                           option("--to", required_text(request, "to"))};
    add_settings(project, request.value("settings", Json::object()), arguments);
    add_region(project, request, arguments);
    return arguments;
}

StudioCommands::Arguments StudioCommands::relight(const StudioProject& project,
                                                  const Json& request) const {
    Arguments arguments;
    const std::string from = text_of(request, "from"), to = text_of(request, "to");
    if (!to.empty()) arguments = {option("--from", from), option("--to", to)};
    for (const char* key : {"light", "from_light"})
        if (const std::string name = text_of(request, key); !name.empty() && name != "sky")
            arguments.push_back(option(std::string(key) == "light" ? "--light" : "--from-light",
                                       light(project, name)));
    const std::pair<const char*, const char*> options[] = {
        {"hour", "--sky"},          {"sun", "--sun"},           {"lit", "--lit"},
        {"rotate", "--rotate"},     {"tilt", "--tilt"},         {"tint", "--tint"},
        {"exposure", "--exposure"}, {"strength", "--strength"}, {"light_model", "--light-model"}};
    for (const auto& [key, flag] : options) {
        const auto value = request.find(key);
        if (value == request.end() || value->is_null() || *value == "") continue;
        arguments.push_back(
            option(flag, fmt::format("{}", fmt::join(value_texts(key, *value), ","))));
    }
    if (arguments.empty()) throw InputError("relight", "expected a light, an hour, a sun or words");
    return arguments;
}

StudioCommands::Arguments StudioCommands::reconstruct(const StudioProject& project,
                                                      const Json&) const {
    const fs::path photographs = folders_.project(project.id) / "photographs";
    for (const char* name : {"transforms.json", "transforms_train.json", "poses_bounds.npy",
                             "sparse", "colmap/sparse"})
        if (fs::exists(photographs / name)) return {"photographs"};
    return {option("--from-images", "photographs")};
}

StudioCommand StudioCommands::make(const StudioProject& project, const StudioResult& result,
                                   const StudioResult* parent) const {
    StudioCommand command{result.kind == "reconstruct" ? "reconstruct" : "edit", {result.kind}};
    Arguments more;
    if (result.kind == "edit")
        more = edit(project, result.request);
    else if (result.kind == "relight")
        more = relight(project, result.request);
    else if (result.kind == "reconstruct")
        more = reconstruct(project, result.request);
    else
        throw InputError("kind", "must be edit, relight or reconstruct");
    if (result.kind != "reconstruct")
        command.arguments.push_back(model_path(folders_, project, parent));
    command.arguments.insert(command.arguments.end(), more.begin(), more.end());
    command.arguments.insert(command.arguments.end(), {"-o", result_folder_name(result.id)});
    return command;
}

StudioCommand StudioCommands::region(const StudioProject& project, const Json& request,
                                     const StudioResult* parent, const std::string& folder) const {
    StudioCommand command{"edit", {"region", model_path(folders_, project, parent)}};
    add_region(project, request, command.arguments);
    for (const char* key : {"from", "to"})
        if (request.contains("region") && request["region"] == Json::array({"auto"}))
            command.arguments.push_back(
                option(std::string("--") + key, required_text(request, key)));
    command.arguments.insert(command.arguments.end(), {"-o", folder});
    return command;
}

}  // namespace item3d
