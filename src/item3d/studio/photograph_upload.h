// A folder of photographs as it arrives, file by file.
#pragma once

#include "item3d/studio/bounded_file.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace item3d {

/// Keeps files where they lay in the folder that was chosen, under names that are safe to write
/// (stored_path), which the frames of a transforms.json follow.
class PhotographUpload {
  public:
    /// longest: bytes of all files together.
    PhotographUpload(std::filesystem::path folder, std::size_t longest);

    /// A file begins. field: "masks" puts it into masks/. Throws InputError for another kind of
    /// file, for more than a thousand, and for two of one name.
    void begin(const std::string& field, const std::string& given);
    void add(const char* data, std::size_t size);
    /// After the last file.
    void end();
    /// Of files so far.
    std::size_t count() const { return count_; }

  private:
    void close();

    std::filesystem::path folder_;
    std::unique_ptr<BoundedFile> file_;
    std::size_t left_;
    std::size_t count_ = 0;
};

}  // namespace item3d
