// File written in pieces up to a maximum size.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>

namespace item3d {

class BoundedFile {
  public:
    BoundedFile(const std::filesystem::path& path, std::size_t longest);
    /// Appends data. Throws InputError if the total exceeds `longest` bytes, and ResourceError if
    /// the disk is full.
    void add(const char* data, std::size_t size);
    void close();

  private:
    std::ofstream file_;
    std::size_t left_;
};

}  // namespace item3d
