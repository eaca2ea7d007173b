#include "item3d/studio/photograph_upload.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/replace_file.h"
#include "item3d/studio/folders.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t max_photographs = 1000;
constexpr std::array kinds = {".png",  ".jpg",  ".jpeg", ".webp", ".tif",
                              ".tiff", ".json", ".npy",  ".bin",  ".txt"};

/// Replaces the file names in the frames of a transforms.json with the stored names.
void follow_names(const fs::path& file) {
    Json transforms = parse_json(read_text(file));
    if (!transforms.is_object() || !transforms.contains("frames") ||
        !transforms["frames"].is_array())
        return;  // the program that reads it reports the error
    for (Json& frame : transforms["frames"])
        for (const char* key : {"file_path", "mask_path"})
            if (frame.is_object() && frame.contains(key) && frame[key].is_string())
                frame[key] = stored_path(frame[key].get<std::string>()).string();
    replace_file(file, transforms.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

PhotographUpload::PhotographUpload(fs::path folder, std::size_t longest)
    : files_(std::move(folder), longest) {}

void PhotographUpload::begin(const std::string& field, const std::string& given) {
    files_.close();
    if (given.empty()) return;
    if (++count_ > max_photographs)
        throw InputError("photographs", fmt::format("are more than {}", max_photographs));
    const fs::path name = stored_path(given);
    if (std::find(kinds.begin(), kinds.end(), name.extension()) == kinds.end())
        throw InputError(shown_name(given, "file"), "is not a photograph",
                         "choose JPEG, PNG, WebP or TIFF images");
    const bool is_mask = field == "masks" && *name.begin() != "masks";
    const fs::path file = is_mask ? "masks" / name : name;
    if (fs::exists(files_.folder() / file))
        throw InputError(shown_name(given, "file"), "has the name of another photograph",
                         "use unique names of letters, digits, - and _");
    files_.begin(file);
}

void PhotographUpload::add(const char* data, std::size_t size) {
    files_.add(data, size);
}

void PhotographUpload::end() {
    files_.close();
    for (const auto& entry : fs::directory_iterator(files_.folder()))
        if (entry.path().filename().string().starts_with("transforms") &&
            entry.path().extension() == ".json")
            follow_names(entry.path());
}

}  // namespace item3d
