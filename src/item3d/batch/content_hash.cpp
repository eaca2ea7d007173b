#include "item3d/batch/content_hash.h"

#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Hashes a file in pieces, because the file of a prior or a model may be larger than memory.
std::string hash_of_bytes(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::error_code code;
    const std::uintmax_t size = fs::file_size(path, code);
    if (!file || code) return "";
    Digest digest(DigestKind::sha256, size);
    std::vector<char> piece(1 << 20);
    while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())) || file.gcount() > 0)
        digest.update({reinterpret_cast<const std::uint8_t*>(piece.data()),
                       static_cast<std::size_t>(file.gcount())});
    return digest.finish();
}

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

/// Returns the last word of each line that begins with one of the keys.
std::vector<std::string> last_words(const fs::path& path, const std::vector<std::string>& keys) {
    std::vector<std::string> names;
    std::error_code code;
    if (!fs::is_regular_file(path, code)) return names;
    std::istringstream lines(read_text(path));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string key, last;
        words >> key;
        for (std::string word; words >> word;)
            last = word;
        if (last.empty()) continue;
        if (std::any_of(keys.begin(), keys.end(),
                        [&](const std::string& known) { return key.starts_with(known); }))
            names.push_back(last);
    }
    return names;
}

std::vector<std::string> files_of_obj(const fs::path& path) {
    std::vector<std::string> names = last_words(path, {"mtllib"});
    const std::vector<std::string> libraries = names;
    for (const std::string& library : libraries)
        for (const std::string& name :
             last_words(path.parent_path() / library, {"map_", "norm", "bump", "refl", "disp"}))
            names.push_back((fs::path(library).parent_path() / name).string());
    return names;
}

}  // namespace

const std::string& ContentHashes::of(const fs::path& path) {
    const auto [place, is_new] = known_.try_emplace(path);
    if (!is_new) return place->second;
    std::error_code code;
    if (fs::is_regular_file(path, code)) {
        place->second = hash_of_bytes(path);
    } else if (fs::is_directory(path, code)) {
        std::vector<fs::path> files;
        for (const auto& entry : fs::recursive_directory_iterator(path, code))
            if (entry.is_regular_file()) files.push_back(entry.path());
        std::sort(files.begin(), files.end());
        std::string all;
        for (const fs::path& file : files)
            all += file.lexically_relative(path).string() + '\0' + hash_of_bytes(file) + '\n';
        place->second = sha256(all);
    }
    return place->second;
}

const std::string& ContentHashes::of_model(const fs::path& path) {
    const auto [place, is_new] = models_.try_emplace(path);
    if (!is_new) return place->second;
    const std::string own = of(path);
    if (own.empty()) return place->second;
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    const std::vector<std::string> names = extension == ".gltf"  ? files_of_gltf(path)
                                           : extension == ".obj" ? files_of_obj(path)
                                                                 : std::vector<std::string>();
    std::string all = own;
    for (const std::string& name : names)
        all += '\n' + name + '\0' + of(path.parent_path() / name);
    place->second = names.empty() ? own : sha256(all);
    return place->second;
}

}  // namespace item3d
