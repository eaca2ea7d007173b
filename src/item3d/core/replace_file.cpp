#include "item3d/core/replace_file.h"

#include "item3d/core/error.h"

#include <fstream>

namespace item3d {

namespace fs = std::filesystem;

void replace_file(const fs::path& path, std::string_view bytes) {
    fs::path temporary = path;
    temporary += ".tmp";
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    std::error_code code;
    if (file) fs::rename(temporary, path, code);
    if (file && !code) return;
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw ResourceError(path.string() + ": cannot be written");
}

}  // namespace item3d
