#include "item3d/mcp/allowed_folders.h"

#include "item3d/core/error.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;

bool is_inside(const fs::path& path, const fs::path& folder) {
    const auto [in_folder, rest] =
        std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
    return in_folder == folder.end();
}

fs::path canonical_folder(const fs::path& folder) {
    std::error_code code;
    fs::path found = fs::canonical(folder, code);
    if (code || !fs::is_directory(found))
        throw InputError(folder.string(), "is not an existing folder",
                         "give folders that agents may use");
    return found;
}

}  // namespace

AllowedFolders::AllowedFolders(const std::vector<fs::path>& inputs, const fs::path& output) {
    for (const fs::path& folder : inputs)
        folders_.push_back(canonical_folder(folder));
    folders_.push_back(canonical_folder(output));
}

fs::path AllowedFolders::existing(const std::string& path, const std::string& argument) const {
    const std::string subject = argument + " " + path;
    if (path.empty() || path.find('\0') != std::string::npos)
        throw InputError(argument, "is not a path");
    bool is_outside = false;
    for (const fs::path& folder : folders_) {
        std::error_code code;
        const fs::path found = fs::canonical(folder / path, code);
        if (code) continue;
        const bool is_allowed =
            std::any_of(folders_.begin(), folders_.end(),
                        [&](const fs::path& allowed) { return is_inside(found, allowed); });
        if (is_allowed) return found;
        is_outside = true;
    }
    std::string list;
    for (const fs::path& folder : folders_)
        list += (list.empty() ? "" : ", ") + folder.string();
    if (is_outside)
        throw InputError(subject, "is outside the folders of this server",
                         "choose a file in " + list);
    throw InputError(subject, "does not exist", "choose a file in " + list);
}

fs::path AllowedFolders::make_result(const std::string& name) const {
    constexpr int maximum = 1000000;
    for (int i = 1; i < maximum; ++i) {
        const fs::path folder = output() / (name + "-" + std::to_string(i));
        std::error_code code;
        if (fs::create_directory(folder, code)) return folder;
        if (code) throw ResourceError(folder.string() + ": cannot be created: " + code.message());
    }
    throw ResourceError(output().string() + ": has too many results named " + name);
}

}  // namespace item3d
