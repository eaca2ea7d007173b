#include "item3d/serve/folder_lock.h"

#include "item3d/core/error.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace item3d {

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& owner) {
    const std::filesystem::path path = folder / "lock";
    file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file_ < 0)
        throw InputError(path.string(),
                         std::string("cannot be written (") + std::strerror(errno) + ")",
                         "check the permissions of the folder");
    if (::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
    ::close(file_);
    throw InputError(folder.string(), "is already served by another " + owner,
                     "stop it first, or use its links");
}

FolderLock::~FolderLock() {
    ::close(file_);
}

}  // namespace item3d
