// Upload of a folder of photographs, file by file.
#pragma once

#include "item3d/studio/folder_upload.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace item3d {

/// Stores the files of a folder that the user chose, in the same subfolders and under safe names
/// (stored_path). The frames of a transforms.json are changed to these names.
class PhotographUpload {
  public:
    /// longest: maximum number of bytes of all files together.
    PhotographUpload(std::filesystem::path folder, std::size_t longest);

    /// Begins a file. If `field` is "masks", the file is stored in masks/. Throws InputError for
    /// another kind of file, for more than a thousand, and for duplicate names.
    void begin(const std::string& field, const std::string& given);
    void add(const char* data, std::size_t size);
    /// Completes the upload, after the last file.
    void end();
    /// Returns the number of files so far.
    std::size_t count() const { return count_; }

  private:
    FolderUpload files_;
    std::size_t count_ = 0;
};

}  // namespace item3d
