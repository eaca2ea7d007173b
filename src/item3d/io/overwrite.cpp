#include "item3d/io/overwrite.h"

#include "item3d/core/error.h"
#include "item3d/core/named_files.h"
#include "item3d/io/resources.h"
#include "item3d/io/text.h"

#include <algorithm>

namespace item3d {

namespace fs = std::filesystem;

namespace {

bool has_extension(const fs::path& path, const char* extension) {
    return to_lower(path.extension().string()) == extension;
}

bool is_same_file(const fs::path& a, const fs::path& b) {
    std::error_code ignored;
    return fs::equivalent(a, b, ignored);
}

/// Returns the existing files that the model names, and an .obj file's library of the same name.
std::vector<fs::path> files_of(const fs::path& model) {
    std::vector<fs::path> files;
    for (const std::string& name : files_named_by(model)) {
        try {
            files.push_back(
                resolve_in_folder(model.parent_path(), name, model.string(), Forgiving::silently));
        } catch (const InputError&) {
            // The reader of the model reports it.
        }
    }
    if (has_extension(model, ".obj")) files.push_back(fs::path(model).replace_extension(".mtl"));
    return files;
}

fs::path canonical_folder(const fs::path& folder) {
    std::error_code ignored;
    const fs::path place = fs::weakly_canonical(fs::absolute(folder), ignored);
    return place.has_filename() ? place : place.parent_path();  // without a slash at its end
}

bool is_below(const fs::path& path, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
           folder.end();
}

bool can_have_textures_of(const fs::path& model, const std::vector<fs::path>& texture_folders,
                          const fs::path& place) {
    for (const fs::path& folder : texture_folders)
        if (is_below(place, canonical_folder(folder))) return true;
    if (has_extension(model, ".glb") || has_extension(model, ".vrm")) return false;
    for (const fs::path& file : files_of(model))
        if (is_below(canonical_folder(file), place)) return true;
    std::error_code ignored;
    const fs::path beside_target = fs::weakly_canonical(model, ignored).parent_path();
    for (const fs::path& folder :
         {canonical_folder(fs::absolute(model).parent_path()), beside_target})
        if (folder == place || folder == place.parent_path()) return true;
    return false;
}

}  // namespace

void check_not_replaced(const fs::path& model, const fs::path& result) {
    if (is_same_file(model, result))
        throw InputError(model.string(), "is the input model, which would be overwritten",
                         "choose another output with -o");
    if (!has_extension(model, ".obj") || !has_extension(result, ".obj")) return;
    const fs::path library = fs::path(result).replace_extension(".mtl");
    std::error_code ignored;
    if (!fs::exists(library, ignored)) return;
    for (const fs::path& file : files_of(model))
        if (is_same_file(file, library))
            throw InputError(library.string(),
                             "is used by the input model and would be overwritten",
                             "choose another output with -o");
}

void check_textures_not_replaced(const fs::path& model,
                                 const std::vector<fs::path>& texture_folders,
                                 const fs::path& written) {
    std::error_code ignored;
    if (fs::is_directory(written, ignored) &&
        can_have_textures_of(model, texture_folders, canonical_folder(written)))
        throw InputError(written.string(),
                         "can have textures of the input model, which could be overwritten",
                         "choose another folder with -o");
}

}  // namespace item3d
