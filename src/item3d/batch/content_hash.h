// Hashes of files that decide a result.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace item3d {

/// Hashes of files and folders, each read once.
class ContentHashes {
  public:
    /// Of a file's bytes, or of the names and bytes of all files in a folder. "" where there is
    /// neither.
    const std::string& of(const std::filesystem::path& path);
    /// Of a model's file and of those that it names: buffers and pictures of a .gltf, material
    /// libraries of an .obj and their pictures. "" where there is no such file.
    const std::string& of_model(const std::filesystem::path& path);

  private:
    std::map<std::filesystem::path, std::string> known_, models_;
};

}  // namespace item3d
