#include "item3d/core/named_files.h"

#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace item3d {
namespace {

namespace fs = std::filesystem;

std::string decode_percent(const std::string& uri) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size()) {
            text += static_cast<char>(std::strtol(uri.substr(i + 1, 2).c_str(), nullptr, 16));
            i += 2;
        } else {
            text += uri[i];
        }
    }
    return text;
}

std::vector<std::string> files_of_gltf(const fs::path& path) {
    std::vector<std::string> names;
    const auto document = parse_json(read_text(path));
    if (!document.is_object()) return names;
    for (const char* list : {"buffers", "images"}) {
        if (!document.contains(list) || !document[list].is_array()) continue;
        for (const auto& entry : document[list])
            if (entry.is_object() && entry.contains("uri") && entry["uri"].is_string() &&
                !entry["uri"].get_ref<const std::string&>().starts_with("data:"))
                names.push_back(decode_percent(entry["uri"].get<std::string>()));
    }
    return names;
}

/// Returns the file name in each line of an .obj or .mtl that begins with one of the keys. It is
/// the rest of the line if this is a file in the folder of `path`, and the last word otherwise,
/// because options stand before the name.
std::vector<std::string> names_in_lines(const fs::path& path,
                                        const std::vector<std::string>& keys) {
    std::vector<std::string> names;
    std::error_code code;
    if (!fs::is_regular_file(path, code)) return names;
    std::istringstream lines(read_text(path));
    for (std::string line; std::getline(lines, line);) {
        line.erase(0, line.find_first_not_of(" \t"));
        if (std::none_of(keys.begin(), keys.end(),
                         [&](const std::string& known) { return line.starts_with(known); }))
            continue;
        std::istringstream words(line);
        std::string key;
        words >> key >> std::ws;
        std::string rest;
        std::getline(words, rest);
        while (!rest.empty() && std::isspace(static_cast<unsigned char>(rest.back())))
            rest.pop_back();
        if (rest.empty()) continue;
        const bool is_file = fs::is_regular_file(path.parent_path() / rest, code);
        names.push_back(is_file ? rest : rest.substr(rest.find_last_of(" \t") + 1));
    }
    return names;
}

std::vector<std::string> files_of_obj(const fs::path& path) {
    std::vector<std::string> names = names_in_lines(path, {"mtllib"});
    const std::vector<std::string> libraries = names;
    for (const std::string& library : libraries)
        for (const std::string& name :
             names_in_lines(path.parent_path() / library, {"map_", "norm", "bump", "refl", "disp"}))
            names.push_back((fs::path(library).parent_path() / name).string());
    return names;
}

}  // namespace

std::vector<std::string> files_named_by(const fs::path& model) {
    std::string extension = model.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (extension == ".gltf") return files_of_gltf(model);
    return extension == ".obj" ? files_of_obj(model) : std::vector<std::string>();
}

}  // namespace item3d
