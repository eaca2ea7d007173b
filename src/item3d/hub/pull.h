// A prior from the Hugging Face hub, or a server that speaks its API, into the local cache.
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
    std::string token;  ///< sent to the endpoint's host alone
    std::filesystem::path cache;
    RetryPolicy retry;

    /// Endpoint, token and cache as huggingface_hub finds them: HF_ENDPOINT, HF_TOKEN (else the
    /// file `token` in hub_home_folder()), hub_cache_folder().
    static PullRequest from_environment();
};

struct PullResult {
    std::filesystem::path folder;  ///< the snapshot
    std::string commit;
    std::vector<std::string> files;
    std::uint64_t bytes = 0;             ///< of all files
    std::uint64_t downloaded_bytes = 0;  ///< of those that were not there
};

/// Downloads what select_files() chooses. The snapshot's links and the reference are made when all
/// of it is there. Throws InputError (name, revision, access, contents), ResourceError (network,
/// disk) and Interrupted; what was downloaded until then is kept, and used by the next call.
PullResult pull(const PullRequest& request);

}  // namespace item3d
