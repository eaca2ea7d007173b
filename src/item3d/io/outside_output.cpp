#include "item3d/io/outside_output.h"

#include "item3d/core/error.h"
#include "item3d/io/text.h"

#include <algorithm>

namespace item3d {

namespace fs = std::filesystem;

namespace {

fs::path canonical_folder(const fs::path& folder) {
    std::error_code ignored;
    const fs::path place = fs::weakly_canonical(fs::absolute(folder), ignored);
    return place.has_filename() ? place : place.parent_path();  // without a slash at its end
}

/// Returns the path without links in its folders. The file itself may be a link.
fs::path canonical_place(const fs::path& file) {
    return canonical_folder(fs::absolute(file).parent_path()) / file.filename();
}

bool is_below(const fs::path& path, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
           folder.end();
}

}  // namespace

void check_not_replaced(const fs::path& model, const fs::path& result) {
    std::error_code ignored;
    if (canonical_place(model) == canonical_place(result) || fs::equivalent(model, result, ignored))
        throw InputError(model.string(), "is the input model, which would be overwritten",
                         "choose another folder with -o");
}

void check_textures_not_replaced(const fs::path& model,
                                 const std::vector<fs::path>& texture_folders,
                                 const fs::path& written) {
    std::error_code ignored;
    if (!fs::is_directory(written, ignored)) return;
    const fs::path place = canonical_folder(written);
    const std::string extension = to_lower(model.extension().string());
    bool may_replace = std::any_of(
        texture_folders.begin(), texture_folders.end(),
        [&](const fs::path& folder) { return is_below(place, canonical_folder(folder)); });
    if (extension != ".glb" && extension != ".vrm") {
        for (const fs::path& folder : {canonical_place(model).parent_path(),
                                       fs::weakly_canonical(model, ignored).parent_path()})
            may_replace = may_replace || folder == place || folder == place.parent_path();
    }
    if (may_replace)
        throw InputError(written.string(),
                         "can have textures of the input model, which could be overwritten",
                         "choose another folder with -o");
}

}  // namespace item3d
