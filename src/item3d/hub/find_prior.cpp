#include "item3d/hub/find_prior.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/hub/cache.h"

#include <fmt/format.h>

#include <cstdlib>

namespace item3d {

namespace fs = std::filesystem;

fs::path installed_priors_folder() {
    if (const char* data = std::getenv("XDG_DATA_HOME"); data && *data)
        return fs::path(data) / "item3d" / "priors";
    const char* home = std::getenv("HOME");
    return fs::path(home ? home : "") / ".local" / "share" / "item3d" / "priors";
}

fs::path find_prior(const std::string& name) {
    if (name.empty() || name == "embedded") return assets_folder() / "prior";
    std::error_code too_long;
    if (fs::is_directory(name, too_long)) return name;

    if (name.find('/') == std::string::npos) {
        const fs::path installed = installed_priors_folder() / name;
        if (name != "." && name != ".." && fs::is_directory(installed, too_long)) return installed;
        throw InputError(
            name,
            fmt::format("unknown prior: there is no such folder, and no prior of that name in {}",
                        installed_priors_folder().string()),
            "give a folder in the diffusers layout, 'embedded', or org/name of the Hugging Face "
            "hub");
    }
    const auto repository = RepositoryName::parse(name);
    if (!repository)
        throw InputError(name, "no such folder",
                         "give a folder in the diffusers layout (with model_index.json)");
    const CachedRepository cached(hub_cache_folder(), repository->name);
    if (!cached.exists())
        throw InputError(
            name,
            fmt::format("no such folder, and no such repository in the Hugging Face cache {}",
                        hub_cache_folder().string()),
            "run: item3d prior pull " + name);
    return cached.find_snapshot(repository->revision_or_main());
}

fs::path find_in_prior(const fs::path& prior, const std::string& name) {
    const fs::path folder = prior / name;
    const bool is_there =
        fs::exists(folder / "config.json") || fs::exists(folder / "model_index.json");
    return is_there ? folder : fs::path();
}

}  // namespace item3d
