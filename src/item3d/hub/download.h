// The download of one file of the hub into the cache's blobs.
#pragma once

#include "item3d/hub/backoff.h"
#include "item3d/hub/cache.h"
#include "item3d/hub/http.h"

#include <cstdint>
#include <functional>
#include <string>

namespace item3d {

/// A file's properties in the hub's headers.
struct RemoteFile {
    std::string path;  ///< in the repository
    std::string url;
    std::string etag;  ///< usually its SHA-256 or git's SHA-1; also the blob's name
    std::uint64_t size = 0;
};

/// True if the blob exists and is complete.
bool has_blob(const CachedRepository& cache, const RemoteFile& file);
/// Returns the size of an interrupted download.
std::uint64_t partial_size(const CachedRepository& cache, const RemoteFile& file);

/// Downloads the blob unless it exists. The bytes accumulate in blobs/ETAG.incomplete. An
/// interrupted download keeps this file, and the next call continues it. The file is renamed to
/// blobs/ETAG only when size and checksum match. A lock excludes other programs. progress: receives
/// the number of bytes present. Throws ResourceError (network, disk), InputError (refused, or
/// damaged, in which case the file is removed), Interrupted.
void download_blob(HttpClient& client, const CachedRepository& cache, const RemoteFile& file,
                   RetryPolicy retry, const std::function<void(std::uint64_t)>& progress);

}  // namespace item3d
