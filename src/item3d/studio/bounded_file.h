// A file that is written in pieces and may not become too large.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>

namespace item3d {

class BoundedFile {
  public:
    BoundedFile(const std::filesystem::path& path, std::size_t longest);
    /// Throws InputError where more than `longest` bytes come, ResourceError where the disk is
    /// full.
    void add(const char* data, std::size_t size);
    void close();

  private:
    std::ofstream file_;
    std::size_t left_;
};

}  // namespace item3d
