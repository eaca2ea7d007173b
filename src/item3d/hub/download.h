// The download of one file from the Hugging Face hub into the blobs of the cache.
#pragma once

#include "item3d/hub/backoff.h"
#include "item3d/hub/cache.h"
#include "item3d/hub/http.h"

#include <cstdint>
#include <functional>
#include <string>

namespace item3d {

/// A file's properties, as the hub's HTTP headers tell them.
struct RemoteFile {
    std::string path;  ///< path in the repository
    std::string url;
    std::string etag;  ///< usually the file's SHA-256 or git's SHA-1; also the blob's name
    std::uint64_t size = 0;
};

/// True if the blob exists and is complete.
bool has_blob(const CachedRepository& cache, const RemoteFile& file);
/// Returns the size of an interrupted download.
std::uint64_t partial_size(const CachedRepository& cache, const RemoteFile& file);

/// Downloads the blob unless it exists. The bytes accumulate in blobs/ETAG.incomplete. An
/// interrupted download keeps this file, and the next call continues it. The file is renamed to
/// blobs/ETAG only when size and checksum match. A lock excludes other programs. progress: receives
/// the number of bytes present. Throws ResourceError for an error of the network or the disk,
/// InputError for a refused request or a damaged file, which is removed, and Interrupted.
void download_blob(HttpClient& client, const CachedRepository& cache, const RemoteFile& file,
                   RetryPolicy retry, const std::function<void(std::uint64_t)>& progress);

}  // namespace item3d
