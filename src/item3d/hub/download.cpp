#include "item3d/hub/download.h"

#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/hub/file_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

namespace item3d {
namespace {

namespace fs = std::filesystem;

fs::path partial_path(const CachedRepository& cache, const RemoteFile& file) {
    return cache.blob(file.etag + ".incomplete");
}

std::uint64_t size_of(const fs::path& path) {
    std::error_code code;
    const auto size = fs::file_size(path, code);
    return code ? 0 : static_cast<std::uint64_t>(size);
}

/// An incomplete download, with its size and running checksum.
class PartialFile {
  public:
    PartialFile(fs::path path, const RemoteFile& file)
        : path_(std::move(path)),
          file_(file),
          kind_(digest_kind(file.etag)),
          digest_(kind_, file.size),
          descriptor_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
        if (descriptor_ < 0) fail(errno);
        try {
            read_what_is_there();
        } catch (...) {
            ::close(descriptor_);
            throw;
        }
    }
    ~PartialFile() { ::close(descriptor_); }
    PartialFile(const PartialFile&) = delete;
    PartialFile& operator=(const PartialFile&) = delete;

    std::uint64_t size() const { return size_; }

    void restart() {
        if (::ftruncate(descriptor_, 0) != 0 || ::lseek(descriptor_, 0, SEEK_SET) != 0) fail(errno);
        size_ = 0;
        digest_ = Digest(kind_, file_.size);
    }

    void append(std::span<const std::uint8_t> bytes) {
        if (bytes.size() > file_.size - size_) damaged("is larger than announced");
        while (!bytes.empty()) {
            const ssize_t wrote = ::write(descriptor_, bytes.data(), bytes.size());
            if (wrote < 0 && errno == EINTR) continue;
            if (wrote < 0) fail(errno);
            const auto count = static_cast<std::size_t>(wrote);
            digest_.update(bytes.first(count));
            size_ += count;
            bytes = bytes.subspan(count);
        }
    }

    /// Verifies the file and renames it.
    void finish(const fs::path& final_path) {
        if (kind_ != DigestKind::none && digest_.finish() != file_.etag)
            damaged("does not have the checksum that the hub announced");
        // If the file system's locks are ineffective, two programs may have written here.
        if (size_of(path_) != file_.size) damaged("was also written by another program");
        if (::fsync(descriptor_) != 0 && errno != EINVAL) fail(errno);
        std::error_code code;
        fs::rename(path_, final_path, code);
        if (code) fail(code.value());
        sync_folder(final_path.parent_path());
    }

  private:
    void read_what_is_there() {
        std::vector<std::uint8_t> buffer(std::size_t(1) << 20);
        for (;;) {
            if (interrupted()) throw Interrupted("during the download");
            const ssize_t count = ::read(descriptor_, buffer.data(), buffer.size());
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) fail(errno);
            if (count == 0) break;
            size_ += static_cast<std::uint64_t>(count);
            if (size_ > file_.size) return restart();
            digest_.update(std::span(buffer).first(static_cast<std::size_t>(count)));
        }
    }

    [[noreturn]] void damaged(const std::string& problem) {
        std::error_code ignored;
        fs::remove(path_, ignored);
        throw InputError(file_.path, problem + "; the partial download was deleted",
                         "run the same command again");
    }

    [[noreturn]] void fail(int error) const {
        const std::string reason = std::strerror(error);
        if (error == ENOSPC || error == EDQUOT || error == EFBIG)
            throw ResourceError(path_.string() + ": cannot be written: " + reason +
                                "; free some space and run the same command again to continue");
        throw InputError(path_.string(), "cannot be written: " + reason,
                         "set HF_HUB_CACHE to a folder that you may write to");
    }

    fs::path path_;
    const RemoteFile& file_;
    DigestKind kind_;
    Digest digest_;
    int descriptor_;
    std::uint64_t size_ = 0;
};

/// Requests the missing rest of the file, without retries.
void fetch_rest(HttpClient& client, PartialFile& partial, const RemoteFile& file,
                const std::function<void(std::uint64_t)>& progress) {
    const std::uint64_t offset = partial.size();
    const auto begin = [&](const HubResponse& response) {
        if (response.status == 200) {
            // The server sends the whole file, even if only a part was requested.
            partial.restart();
        } else if (!response.header("content-range")
                        .starts_with(fmt::format("bytes {}-", offset))) {
            partial.restart();
            throw ConnectionError("the server sent a different part of the file than requested");
        }
    };
    const auto receive = [&](std::span<const std::uint8_t> bytes) {
        partial.append(bytes);
        progress(partial.size());
    };
    const HubResponse response = client.download(file.url, offset, begin, receive);
    if (response.status == 416) {
        partial.restart();
        throw ConnectionError("the server does not have the requested part");
    }
    if (response.status != 200 && response.status != 206)
        throw InputError(file.path, fmt::format("the hub answered with status {}", response.status),
                         "run the same command again");
    if (partial.size() < file.size)
        throw ConnectionError(
            fmt::format("{}: received {} of {} bytes", file.path, partial.size(), file.size));
}

}  // namespace

bool has_blob(const CachedRepository& cache, const RemoteFile& file) {
    const fs::path blob = cache.blob(file.etag);
    return fs::is_regular_file(blob) && size_of(blob) == file.size;
}

std::uint64_t partial_size(const CachedRepository& cache, const RemoteFile& file) {
    const std::uint64_t size = size_of(partial_path(cache, file));
    return size > file.size ? 0 : size;
}

void download_blob(HttpClient& client, const CachedRepository& cache, const RemoteFile& file,
                   RetryPolicy retry, const std::function<void(std::uint64_t)>& progress) {
    const FileLock lock(cache.lock(file.etag));
    if (has_blob(cache, file)) {
        progress(file.size);
        return;
    }
    std::error_code code;
    fs::create_directories(cache.folder() / "blobs", code);
    PartialFile partial(partial_path(cache, file), file);
    Backoff backoff(retry);
    while (partial.size() < file.size) {
        try {
            fetch_rest(client, partial, file, progress);
        } catch (const ConnectionError& failure) {
            backoff.wait(failure, partial.size());
        }
    }
    partial.finish(cache.blob(file.etag));
    progress(file.size);
}

}  // namespace item3d
