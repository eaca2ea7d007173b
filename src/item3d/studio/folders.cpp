#include "item3d/studio/folders.h"

#include "item3d/core/files.h"
#include "item3d/io/file_names.h"
#include "item3d/io/text.h"
#include "item3d/serve/secret.h"

#include <algorithm>
#include <regex>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

void replace_all(std::string& text, const std::string& what, const std::string& with) {
    for (std::size_t at = 0; !what.empty() && (at = text.find(what, at)) != std::string::npos;
         at += with.size())
        text.replace(at, what.size(), with);
}

/// Returns the part after the last "/" or "\".
std::string last_part(const std::string& name) {
    const std::size_t slash = name.find_last_of("/\\");
    return slash == std::string::npos ? name : name.substr(slash + 1);
}

}  // namespace

StudioFolders::StudioFolders(fs::path root, fs::path programs)
    : root_(fs::absolute(root)), programs_(std::move(programs)), assets_(assets_folder()) {
    for (const char* name : {"projects", "incoming"})
        make_output_folder(root_ / name);
}

fs::path StudioFolders::project(std::int64_t id) const {
    return root_ / "projects" / std::to_string(id);
}

fs::path StudioFolders::result(std::int64_t project, std::int64_t id) const {
    return this->project(project) / result_folder_name(id);
}

fs::path StudioFolders::incoming(const std::string& extension) const {
    constexpr int name_bytes = 8;
    return root_ / "incoming" / (random_secret(name_bytes) + extension);
}

fs::path StudioFolders::program(const std::string& family) const {
    return programs_ / ("item3d-" + family);
}

void StudioFolders::clear_incoming() const {
    for (const auto& entry : fs::directory_iterator(root_ / "incoming")) {
        std::error_code ignored;
        fs::remove_all(entry.path(), ignored);
    }
}

std::string StudioFolders::without_paths(std::string text) const {
    for (const fs::path& folder : {root_, assets_, fs::weakly_canonical(assets_), programs_}) {
        replace_all(text, folder.string() + "/", "");
        replace_all(text, folder.string(), folder.filename().string());
    }
    static const std::regex source("(projects/[0-9]+/source|incoming/[0-9a-f]+)/");
    return std::regex_replace(text, source, "");
}

std::string result_folder_name(std::int64_t result) {
    return "results/" + std::to_string(result);
}

std::string shown_name(const std::string& given, const std::string& otherwise) {
    constexpr std::size_t longest = 120;
    std::string name = to_utf8(last_part(given));
    std::erase_if(name, [](unsigned char letter) { return letter < 32 || letter == 127; });
    name = std::string(trim(shortened(name, longest)));
    return name.empty() || name == "." || name == ".." ? otherwise : name;
}

fs::path stored_path(const std::string& given) {
    constexpr std::size_t deepest = 4;
    std::vector<std::string> parts(1);
    for (const char letter : given)
        if (letter == '/' || letter == '\\')
            parts.emplace_back();
        else
            parts.back() += letter;
    std::erase_if(
        parts, [](const std::string& part) { return part.empty() || part == "." || part == ".."; });
    fs::path path;
    for (std::size_t i = parts.size() - std::min(parts.size(), deepest); i < parts.size(); ++i)
        path /= stored_name(parts[i]);
    return path.empty() ? fs::path("file") : path;
}

std::string stored_name(const std::string& given) {
    const fs::path name(last_part(given));
    const std::string stem = plain_file_name(name.stem().string());
    std::string extension = to_lower(name.extension().string());
    std::erase_if(extension,
                  [](unsigned char letter) { return letter != '.' && !std::isalnum(letter); });
    return (stem.empty() ? "file" : stem) + extension;
}

}  // namespace item3d
