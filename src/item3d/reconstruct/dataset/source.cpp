#include "item3d/reconstruct/dataset/source.h"

#include "item3d/core/error.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace item3d {

namespace {

namespace fs = std::filesystem;

constexpr std::array image_extensions{".png", ".jpg", ".jpeg", ".exr", ".hdr"};

bool has_image_extension(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::find(image_extensions.begin(), image_extensions.end(), extension) !=
           image_extensions.end();
}

/// Replaces Windows separators. Names have the separators of the machine that wrote them.
std::string with_slashes(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return name;
}

}  // namespace

const char* dataset_kind_name(DatasetKind kind) {
    switch (kind) {
        case DatasetKind::nerf_synthetic:
            return "NeRF-synthetic";
        case DatasetKind::nerfstudio:
            return "nerfstudio";
        case DatasetKind::colmap:
            return "COLMAP";
        case DatasetKind::llff:
            return "LLFF";
    }
    check_failed("kind", __FILE__, __LINE__, "an unknown kind of dataset");
}

fs::path inside(const fs::path& folder, const std::string& name, const std::string& subject) {
    const fs::path relative = fs::path(with_slashes(name)).lexically_normal();
    if (name.empty() || relative.is_absolute() || *relative.begin() == "..") {
        throw InputError(subject, "'" + name + "' is not inside " + folder.string(),
                         "images and masks must be inside the dataset's folder");
    }
    return folder / relative;
}

fs::path find_image(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) return path;
    for (const char* extension : image_extensions) {
        fs::path with = path;
        with += extension;
        if (fs::is_regular_file(with, ignored)) return with;
    }
    return path;
}

std::string without_image_extension(const std::string& name) {
    fs::path path = fs::path(with_slashes(name)).lexically_normal();
    if (has_image_extension(path)) path.replace_extension();
    return path.string();
}

std::vector<fs::path> list_images(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        if (has_image_extension(i->path())) found.push_back(i->path());
    }
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace item3d
