// Folders that an agent may read and write.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

class AllowedFolders {
  public:
    /// inputs: folders to read from; output: folder of results, which is readable too. All must
    /// exist. Throws InputError.
    AllowedFolders(const std::vector<std::filesystem::path>& inputs,
                   const std::filesystem::path& output);

    /// Returns the existing file or folder `path` with links resolved. The path is absolute, or
    /// relative to one of the allowed folders. argument: name of the argument in error messages.
    /// Throws InputError for a path that is missing or outside.
    std::filesystem::path existing(const std::string& path, const std::string& argument) const;

    /// Creates a new folder, such as "edit-mug-3", in the output folder.
    std::filesystem::path make_result(const std::string& name) const;

    const std::vector<std::filesystem::path>& all() const { return folders_; }
    const std::filesystem::path& output() const { return folders_.back(); }

  private:
    std::vector<std::filesystem::path> folders_;  ///< canonical; the output last
};

}  // namespace item3d
