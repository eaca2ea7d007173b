#include "item3d/core/replaceable.h"

#include "item3d/core/error.h"

namespace item3d {

void check_replaceable(const std::filesystem::path& path) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    if (exists(status) && !is_regular_file(status) && !is_directory(status))
        throw InputError(path.string(), "is a device or a pipe, which cannot be replaced by a file",
                         "choose the name of a file");
}

}  // namespace item3d
