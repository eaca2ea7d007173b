// Rules for the files of a model that come from outside: an archive, or several uploaded files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace item3d {

/// Returns `name`, with either separator, as a path within a folder. Throws InputError that begins
/// with `subject` for a name that leaves the folder or has control characters.
std::filesystem::path path_in_folder(std::string name, const std::string& subject);

/// True for models, images, buffers and material libraries, by the extension.
bool is_part_of_model(const std::filesystem::path& name);

/// Chooses the model among the files of a folder: the .glb, .gltf, .vrm or .obj with the fewest
/// parent folders. If there are several, it is the largest of them.
class MainModel {
  public:
    /// path: relative to the folder. size: in bytes.
    void add(const std::filesystem::path& path, std::int64_t size);
    /// Returns the path of the model; empty if there is none.
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    std::ptrdiff_t depth_ = 0;
    std::int64_t size_ = 0;
};

}  // namespace item3d
