#include "item3d/io/obj/libraries.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/resources.h"
#include "item3d/io/text.h"

#include <algorithm>
#include <utility>

namespace item3d {
namespace fs = std::filesystem;

ObjLibraries::ObjLibraries(const fs::path& path, const ObjFile& file)
    : path_(path), names_(file.material_names) {
    std::vector<std::string> problems;
    for (const std::string& statement : file.libraries)
        read_statement(statement, problems);
    const std::string own = any_was_read_ ? "" : read_own_name(file);
    for (const std::string& problem : problems) {
        warn(problem +
             (own.empty() ? "; default materials are used" : "; '" + own + "' is used instead"));
    }
    if (file.libraries.empty() && !own.empty())
        warn(path.string() + ": does not name a material library; '" + own + "' is used");
}

void ObjLibraries::read(const std::string& name) {
    const fs::path folder = path_.parent_path();
    const fs::path library = resolve_beside(folder, {folder}, name, path_.string());
    for (auto& [material_name, material] : read_mtl(library, names_))
        materials_.insert_or_assign(material_name, std::move(material));
    any_was_read_ = true;
}

// Reads the libraries of a statement, which contains one name with blanks, or several names. A "#"
// may belong to a name, or begin a comment.
void ObjLibraries::read_statement(const std::string& statement,
                                  std::vector<std::string>& problems) {
    const std::string bare(without_remark(statement));
    std::vector<std::string> words;
    std::string_view rest = bare;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest))
        words.emplace_back(word);
    std::vector<std::string> problems_of_words;
    const auto try_read = [&](const std::string& name, std::vector<std::string>& errors) {
        try {
            read(name);
            return true;
        } catch (const InputError& error) {
            errors.push_back(error.what());
            return false;
        }
    };
    std::vector<std::string> ignored, problem_of_all;
    if (bare != statement && try_read(statement, ignored)) return;
    if (try_read(bare, problem_of_all)) return;
    if (words.size() > 1) {
        for (const std::string& word : words)
            try_read(word, problems_of_words);
    }
    const bool any_word = words.size() > 1 && problems_of_words.size() < words.size();
    const auto& said = any_word ? problems_of_words : problem_of_all;
    problems.insert(problems.end(), said.begin(), said.end());
}

// Reads the library with the OBJ file's name. Many programs read only this library, so mtllib may
// name anything.
std::string ObjLibraries::read_own_name(const ObjFile& file) {
    const bool wants_materials = std::any_of(file.material_names.begin(), file.material_names.end(),
                                             [](const std::string& name) { return !name.empty(); });
    const std::string own = path_.stem().string() + ".mtl";
    std::error_code code;
    if (!wants_materials || !fs::is_regular_file(path_.parent_path() / own, code)) return "";
    try {
        read(own);
    } catch (const InputError& error) {
        warn(error.what());
        return "";
    }
    return own;
}

const MtlMaterial* ObjLibraries::find(const std::string& name) const {
    const auto exact = materials_.find(name);
    if (exact != materials_.end()) return &exact->second;
    const std::string wanted(without_remark(name));
    for (const bool any_case : {false, true}) {
        for (const auto& [key, material] : materials_) {
            const std::string_view bare = without_remark(key);
            if (any_case ? to_lower(bare) == to_lower(wanted) : bare == wanted) return &material;
        }
    }
    return nullptr;
}

}  // namespace item3d
