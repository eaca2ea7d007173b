#include "item3d/edit/reconstructed_light.h"

#include "item3d/edit/plan.h"

namespace item3d {

std::filesystem::path reconstructed_light(const std::filesystem::path& model) {
    const std::filesystem::path folder = model.parent_path(), light = folder / "light.hdr";
    std::error_code ignored;
    const bool is_there = model.filename() == "model.glb" &&
                          std::filesystem::is_regular_file(folder / "reconstruct.json", ignored) &&
                          std::filesystem::is_regular_file(light, ignored);
    return is_there ? light : std::filesystem::path();
}

bool suits_found_light(const std::filesystem::path& prior, const nlohmann::json& overrides) {
    return overrides.get<EditSettings>().optimize != Optimize::texture ||
           !prior_defaults(prior).contains("light");
}

}  // namespace item3d
