#include "item3d/studio/model_folder.h"

#include "item3d/core/error.h"
#include "item3d/io/file_names.h"
#include "item3d/io/load.h"
#include "item3d/io/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <tuple>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr std::array other_extensions = {".bin",  ".mtl", ".png", ".jpg",  ".jpeg", ".webp",
                                         ".ktx2", ".bmp", ".tga", ".tiff", ".tif",  ".gif"};

}  // namespace

fs::path path_in_folder(std::string name, const std::string& subject) {
    std::replace(name.begin(), name.end(), '\\', '/');
    const bool is_plain = std::none_of(name.begin(), name.end(), [](unsigned char letter) {
        return letter < 32 || letter == 127;
    });
    const fs::path path(name);
    bool is_inside = !name.empty() && !path.is_absolute() && name.find(':') == std::string::npos;
    for (const fs::path& part : path)
        is_inside = is_inside && part != "..";
    if (!is_plain || !is_inside)
        throw InputError(subject, "contains a file name that is invalid or outside its folder",
                         "choose the files of the model's own folder");
    constexpr std::size_t longest_name = 200;  // file systems allow 255 bytes, with endings
    for (const fs::path& part : path)
        if (part.string().size() > longest_name)
            throw InputError(subject,
                             fmt::format("contains a file name of more than {} bytes: {}...",
                                         longest_name, shortened(part.string(), 40)),
                             "rename this file");
    return path.lexically_normal();
}

bool is_part_of_model(const fs::path& name) {
    return is_model_file(name) ||
           std::find(other_extensions.begin(), other_extensions.end(),
                     to_lower(name.extension().string())) != other_extensions.end();
}

void MainModel::add(const fs::path& path, std::int64_t size) {
    if (!is_model_file(path)) return;
    const std::ptrdiff_t depth = std::distance(path.begin(), path.end());
    if (!path_.empty() && std::tuple(depth, -size, path) > std::tuple(depth_, -size_, path_))
        return;
    path_ = path;
    depth_ = depth;
    size_ = size;
}

}  // namespace item3d
