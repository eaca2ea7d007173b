// The folders that an agent may read from and write into.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

class AllowedFolders {
  public:
    /// inputs: folders that files are read from; output: where results go, which is read from too.
    /// All must be there. Throws InputError.
    AllowedFolders(const std::vector<std::filesystem::path>& inputs,
                   const std::filesystem::path& output);

    /// The file or folder of that name, without links: absolute, or seen from one of the folders.
    /// `argument` is named in the message. Throws InputError for one that is not there or outside.
    std::filesystem::path existing(const std::string& path, const std::string& argument) const;

    /// A new folder of the output, as "edit-mug-3".
    std::filesystem::path make_result(const std::string& name) const;

    const std::vector<std::filesystem::path>& all() const { return folders_; }
    const std::filesystem::path& output() const { return folders_.back(); }

  private:
    std::vector<std::filesystem::path> folders_;  ///< canonical; the output last
};

}  // namespace item3d
