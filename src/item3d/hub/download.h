// One file of the hub into the cache's blobs.
#pragma once

#include "item3d/hub/backoff.h"
#include "item3d/hub/cache.h"
#include "item3d/hub/http.h"

#include <cstdint>
#include <functional>
#include <string>

namespace item3d {

/// What the hub's headers say of a file.
struct RemoteFile {
    std::string path;  ///< in the repository
    std::string url;
    std::string etag;  ///< its SHA-256 or git's SHA-1, mostly; the blob's name
    std::uint64_t size = 0;
};

/// True when the blob is there, whole.
bool has_blob(const CachedRepository& cache, const RemoteFile& file);
/// Bytes of it that an interrupted download left.
std::uint64_t partial_size(const CachedRepository& cache, const RemoteFile& file);

/// Fetches the blob unless it is there. The bytes gather in blobs/ETAG.incomplete, which survives
/// interruptions and is continued; only when size and checksum are right does it become blobs/ETAG.
/// A lock keeps other programs off. progress: told how many bytes of this file are there.
/// Throws ResourceError (network, disk), InputError (refused, damaged: the file is then removed),
/// Interrupted.
void download_blob(HttpClient& client, const CachedRepository& cache, const RemoteFile& file,
                   RetryPolicy retry, const std::function<void(std::uint64_t)>& progress);

}  // namespace item3d
