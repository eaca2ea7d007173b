#include "item3d/studio/model_upload.h"

#include "item3d/core/error.h"
#include "item3d/io/load.h"
#include "item3d/studio/archive.h"
#include "item3d/studio/folders.h"

#include <fmt/format.h>

namespace item3d {

namespace fs = std::filesystem;

ModelUpload::ModelUpload(fs::path folder, std::size_t longest)
    : files_(std::move(folder), longest) {}

void ModelUpload::begin(const std::string& name) {
    files_.close();
    if (name.empty()) return;
    const fs::path path = path_in_folder(name, "the upload");
    if (!is_part_of_model(path)) return;
    constexpr ArchiveLimits limits;
    if (++count_ > static_cast<std::size_t>(limits.entries))
        throw InputError("the upload", fmt::format("has more than {} files", limits.entries));
    if (fs::exists(files_.folder() / path))
        throw InputError(shown_name(name, "the file"), "was chosen twice", "choose it once");
    files_.begin(path);
}

void ModelUpload::add(const char* data, std::size_t size) {
    files_.add(data, size);
}

fs::path ModelUpload::end() {
    files_.close();
    MainModel main;
    for (const auto& entry : fs::recursive_directory_iterator(files_.folder()))
        if (entry.is_regular_file())
            main.add(entry.path().lexically_relative(files_.folder()),
                     static_cast<std::int64_t>(entry.file_size()));
    if (main.path().empty())
        throw InputError("the upload", "contains no model", "choose a " + model_extensions_text());
    return main.path();
}

}  // namespace item3d
