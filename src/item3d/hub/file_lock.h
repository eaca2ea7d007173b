// A lock between processes by flock() on a separate file, as huggingface_hub uses it.
#pragma once

#include <filesystem>

namespace item3d {

/// RAII lock. The destructor releases the lock but keeps its file.
class FileLock {
  public:
    /// Blocks until the lock is free, and prints a note if it must wait. Throws InputError if the
    /// file cannot be created or locked, and Interrupted after Ctrl-C.
    explicit FileLock(const std::filesystem::path& path);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

  private:
    int descriptor_;
};

}  // namespace item3d
