// The download of a prior from the Hugging Face hub, or a compatible server, into the local cache.
#pragma once

#include "item3d/hub/backoff.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct PullRequest {
    std::string repository;  ///< "org/name"
    std::string revision = "main";
    std::string variant;  ///< "" or "fp16" (select_files())
    std::string endpoint = "https://huggingface.co";
    std::string token;  ///< sent only to the endpoint's host
    std::filesystem::path cache;
    RetryPolicy retry;

    /// Returns a request whose endpoint, token and cache are those of huggingface_hub. The endpoint
    /// is $HF_ENDPOINT if that is set; the token is $HF_TOKEN or in the file `token` of
    /// hub_home_folder(); the cache is hub_cache_folder().
    static PullRequest from_environment();
};

struct PullResult {
    std::filesystem::path folder;  ///< folder of the snapshot
    std::string commit;
    std::vector<std::string> files;
    std::uint64_t bytes = 0;             ///< total of all files
    std::uint64_t downloaded_bytes = 0;  ///< total of newly downloaded files
};

/// Downloads the files that select_files() selects. When all are complete, creates the snapshot's
/// links and the reference. Throws InputError (name, revision, access, contents), ResourceError
/// (network, disk) and Interrupted. Partial downloads are then kept, and the next call continues
/// them.
PullResult pull(const PullRequest& request);

}  // namespace item3d
