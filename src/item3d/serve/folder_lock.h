// A folder that one program at a time serves.
#pragma once

#include <filesystem>
#include <string>

namespace item3d {

/// Holds the lock of the file `lock` in a folder until the end, however the program ends.
class FolderLock {
  public:
    /// owner: "`item3d study serve`", in the message. Throws InputError where another program has
    /// the folder, or nothing can be written there.
    FolderLock(const std::filesystem::path& folder, const std::string& owner);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

  private:
    int file_ = -1;
};

}  // namespace item3d
