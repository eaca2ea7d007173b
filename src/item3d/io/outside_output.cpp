#include "item3d/io/outside_output.h"

#include "item3d/core/error.h"
#include "item3d/io/text.h"

namespace item3d {

namespace fs = std::filesystem;

void check_outside_output(const fs::path& model, const fs::path& output) {
    std::error_code ignored;
    const fs::path file = fs::weakly_canonical(model, ignored), folder = file.parent_path();
    const fs::path written = fs::weakly_canonical(output / "model", ignored);
    const std::string extension = to_lower(file.extension().string());
    const bool is_one_file = extension == ".glb" || extension == ".vrm";
    const bool is_in_output =
        folder == written.parent_path() || folder == written.parent_path() / "textures";
    if (is_in_output && (!is_one_file || file.stem() == written.stem()))
        throw InputError(model.string(), "lies in the output folder, where it could be overwritten",
                         "choose another folder with -o");
}

}  // namespace item3d
