// Lock that limits a folder to one serving program at a time.
#pragma once

#include <filesystem>
#include <string>

namespace item3d {

/// Holds a lock on the file `lock` of a folder until destruction or the end of the process.
class FolderLock {
  public:
    /// owner: name of the program for the message, such as "`item3d study serve`". Throws
    /// InputError if another program holds the lock, or the folder is not writable.
    FolderLock(const std::filesystem::path& folder, const std::string& owner);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

  private:
    int file_ = -1;
};

}  // namespace item3d
