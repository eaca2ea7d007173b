#include "item3d/hub/file_lock.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

namespace item3d {

FileLock::FileLock(const std::filesystem::path& path) {
    std::error_code code;
    std::filesystem::create_directories(path.parent_path(), code);
    descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0664);
    const auto fail = [&](int error) {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (error == ENOSPC || error == EDQUOT)
            throw ResourceError(path.string() + ": cannot be created: " + std::strerror(error) +
                                "; free some space and run the same command again");
        throw InputError(path.string(),
                         std::string("cannot be created or locked: ") + std::strerror(error),
                         "set HF_HUB_CACHE to a folder that you may write to");
    };
    if (descriptor_ < 0) fail(code ? code.value() : errno);
    bool said = false;
    while (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EINTR) continue;
        if (errno != EWOULDBLOCK) fail(errno);
        if (interrupted()) {
            ::close(descriptor_);
            throw Interrupted("during the download");
        }
        if (!said) note("pull: waiting for another program that is downloading the same file");
        said = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
}

FileLock::~FileLock() {
    ::close(descriptor_);
}

}  // namespace item3d
