// Upload of a model in several files.
#pragma once

#include "item3d/studio/folder_upload.h"
#include "item3d/studio/model_folder.h"

#include <cstddef>
#include <filesystem>
#include <string>

namespace item3d {

/// Stores the files of a model (is_part_of_model) under their own names, because the model refers
/// to them by these names. Other files are ignored.
class ModelUpload {
  public:
    /// longest: maximum number of bytes of all files together.
    ModelUpload(std::filesystem::path folder, std::size_t longest);

    /// Begins a file. name: relative path, with its extension. Throws InputError for a path outside
    /// of the folder, for duplicate names, and for more than 2000 files.
    void begin(const std::string& name);
    void add(const char* data, std::size_t size);
    /// Completes the upload, and returns the path of the model relative to the folder (MainModel).
    /// Throws InputError if there is none.
    std::filesystem::path end();

  private:
    FolderUpload files_;
    std::size_t count_ = 0;
};

}  // namespace item3d
