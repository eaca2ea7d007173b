// Writer of the files of an uploaded folder, up to a total size.
#pragma once

#include "item3d/studio/bounded_file.h"

#include <cstddef>
#include <filesystem>
#include <memory>

namespace item3d {

class FolderUpload {
  public:
    /// Creates the folder. longest: maximum number of bytes of all files together.
    FolderUpload(std::filesystem::path folder, std::size_t longest);

    /// Completes the file before, and creates a file and its folders. path: relative to the folder.
    void begin(const std::filesystem::path& path);
    /// Appends data to the file. Discards the data if no file was begun since close(). Throws like
    /// BoundedFile.
    void add(const char* data, std::size_t size);
    /// Completes the file.
    void close();

    const std::filesystem::path& folder() const { return folder_; }

  private:
    std::filesystem::path folder_;
    std::unique_ptr<BoundedFile> file_;
    std::size_t left_;
};

}  // namespace item3d
