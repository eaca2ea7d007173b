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
    std::string variant;  ///< "" or "fp16", see select_files()
    std::string endpoint = "https://huggingface.co";
    std::string token;  ///< sent only to the endpoint's host
    std::filesystem::path cache;
    RetryPolicy retry;

    /// Returns endpoint, token and cache as in huggingface_hub: HF_ENDPOINT, HF_TOKEN (else the
    /// file `token` in hub_home_folder()), hub_cache_folder().
    static PullRequest from_environment();
};

struct PullResult {
    std::filesystem::path folder;  ///< of the snapshot
    std::string commit;
    std::vector<std::string> files;
    std::uint64_t bytes = 0;             ///< of all files
    std::uint64_t downloaded_bytes = 0;  ///< of newly downloaded files
};

/// Downloads the files that select_files() selects. Creates the snapshot's links and the reference
/// once all are complete. Throws InputError (name, revision, access, contents), ResourceError
/// (network, disk) and Interrupted; partial downloads are kept, and continued by the next call.
PullResult pull(const PullRequest& request);

}  // namespace item3d
