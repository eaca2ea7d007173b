// Hashes of the files that a job's result depends on.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace item3d {

/// Cache of content hashes; each file is read once.
class ContentHashes {
  public:
    /// Returns the hash of a file's bytes, or of the names and bytes of all files in a folder. The
    /// hash is empty if neither exists. Throws InputError if a folder cannot be listed.
    const std::string& of(const std::filesystem::path& path);
    /// Returns the hash of a model's file and of the files that it references. A .gltf references
    /// buffers and images; an .obj references material libraries, which reference images. The hash
    /// is empty if the model's file does not exist or is a folder.
    const std::string& of_model(const std::filesystem::path& path);

  private:
    std::map<std::filesystem::path, std::string> known_, models_;
};

}  // namespace item3d
