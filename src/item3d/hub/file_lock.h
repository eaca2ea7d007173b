// A lock between processes, as huggingface_hub takes it: flock() on a file of its own.
#pragma once

#include <filesystem>

namespace item3d {

/// Held from construction to destruction. The file stays.
class FileLock {
  public:
    /// Waits for the lock and says so. Throws InputError when the file cannot be made or locked,
    /// Interrupted after Ctrl-C.
    explicit FileLock(const std::filesystem::path& path);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

  private:
    int descriptor_;
};

}  // namespace item3d
