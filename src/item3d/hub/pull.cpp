#include "item3d/hub/pull.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/hub/cache.h"
#include "item3d/hub/download.h"
#include "item3d/hub/file_lock.h"
#include "item3d/hub/selection.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Returns an entity tag without quotes and without the mark of a weak tag, which are not part of a
/// blob's name.
std::string plain_etag(std::string etag) {
    if (etag.starts_with("W/")) etag.erase(0, 2);
    std::erase(etag, '"');
    return etag;
}

class Pull {
  public:
    explicit Pull(const PullRequest& request)
        : request_(request),
          client_(request.endpoint, request.token),
          cache_(request.cache, request.repository) {}

    PullResult run() {
        read_file_list();
        check_layout(request_.repository, paths_);
        const RemoteFile model_index = describe("model_index.json");
        const FileSelection selection =
            select_files(request_.repository, text_of(model_index), paths_, request_.variant);
        for (const std::string& path : selection.files)
            files_.push_back(path == model_index.path ? model_index : describe(path));
        for (const std::string& index : selection.indexes) {
            const RemoteFile file = describe(index);
            for (const std::string& shard :
                 shards_of_index(request_.repository, index, text_of(file), paths_))
                files_.push_back(describe(shard));
            files_.push_back(file);
        }
        check_space();
        download();
        return finish();
    }

  private:
    std::string url_of(const std::string& path) const {
        return fmt::format("{}/{}/resolve/{}/{}", request_.endpoint, request_.repository, commit_,
                           encode_url(path, "/"));
    }

    /// Throws InputError for a refused request; the message tells the user what to do.
    void check_access(const HubResponse& response, const std::string& what) const {
        if (response.status == 200 || (response.status >= 300 && response.status < 400)) return;
        const std::string& name = request_.repository;
        const std::string code = response.header("x-error-code");
        const std::string token = request_.token.empty() ? "set HF_TOKEN to an access token"
                                                         : "check that HF_TOKEN has read access";
        if (code == "GatedRepo" || response.status == 403)
            throw InputError(name, fmt::format("is gated (status {})", response.status),
                             fmt::format("accept its licence at {}/{}, then {}", request_.endpoint,
                                         name, token));
        if (response.status == 401)
            throw InputError(
                name,
                "access denied (status 401): the repository does not exist, or is private or gated",
                fmt::format("check its name, or accept its licence at {}/{}, then {}",
                            request_.endpoint, name, token));
        if (response.status == 404 && code == "RevisionNotFound")
            throw InputError(name, fmt::format("has no revision '{}'", request_.revision),
                             "leave out --revision to use its main branch");
        if (response.status == 404)
            throw InputError(name, fmt::format("{} was not found (status 404)", what),
                             fmt::format("check the name and --revision at {}", request_.endpoint));
        throw InputError(name, fmt::format("unexpected status {1} for {0}", what, response.status),
                         "check HF_ENDPOINT");
    }

    HubResponse fetch(const std::string& url, const std::string& what) {
        const HubResponse response =
            with_patience(request_.retry, [&] { return client_.fetch(url); });
        check_access(response, what);
        return response;
    }

    void read_file_list() {
        const std::string what =
            fmt::format("the repository or its revision '{}'", request_.revision);
        const HubResponse response =
            fetch(fmt::format("{}/api/models/{}/revision/{}", request_.endpoint,
                              request_.repository, encode_url(request_.revision)),
                  what);
        const nlohmann::json json = parse_json(response.body);
        if (!json.is_object() || !json.contains("sha") || !json["sha"].is_string() ||
            !json.contains("siblings") || !json["siblings"].is_array())
            throw InputError(request_.endpoint, "does not answer as the Hugging Face hub does",
                             "check HF_ENDPOINT");
        commit_ = json["sha"].get<std::string>();
        if (!is_commit(commit_))
            throw InputError(request_.endpoint, "is not a valid commit: " + commit_);
        for (const auto& sibling : json["siblings"]) {
            const std::string path = sibling.is_object() ? sibling.value("rfilename", "") : "";
            if (!stays_inside(path))
                throw InputError(request_.repository,
                                 fmt::format("lists a file outside its folder: '{}'", path),
                                 "do not use this repository");
            paths_.push_back(path);
        }
    }

    /// Returns a file's tag and size. They are from the hub's own headers, not from those of a
    /// redirect's target.
    RemoteFile describe(const std::string& path) {
        RemoteFile file{path, url_of(path), "", 0};
        const HubResponse response =
            with_patience(request_.retry, [&] { return client_.head(file.url); });
        check_access(response, path);
        const bool linked = response.tells_of_file();
        file.etag = plain_etag(response.header(linked ? "x-linked-etag" : "etag"));
        const std::string size = response.header(linked ? "x-linked-size" : "content-length");
        const auto [end, error] =
            std::from_chars(size.data(), size.data() + size.size(), file.size);
        if (error != std::errc() || end != size.data() + size.size() || file.etag.size() > 200 ||
            !stays_inside(file.etag) || file.etag.find('/') != std::string::npos)
            throw InputError(request_.repository,
                             fmt::format("the hub sent no size or ETag for {}", path),
                             "check HF_ENDPOINT");
        return file;
    }

    /// Downloads a small file that is needed before the others, and returns its text.
    std::string text_of(const RemoteFile& file) {
        constexpr std::uint64_t sensible = std::uint64_t(64) << 20;
        if (file.size > sensible)
            throw InputError(
                request_.repository,
                fmt::format("{} has {} bytes, which is too large for a configuration file",
                            file.path, file.size));
        downloaded_ += has_blob(cache_, file) ? 0 : file.size;
        download_blob(client_, cache_, file, request_.retry, [](std::uint64_t) {});
        return read_text(cache_.blob(file.etag));
    }

    /// Returns the number of bytes still to be downloaded. If the sum overflows, returns the
    /// largest number.
    std::uint64_t missing_bytes() const {
        std::uint64_t missing = 0;
        for (const RemoteFile& file : files_) {
            const std::uint64_t rest =
                has_blob(cache_, file) ? 0 : file.size - partial_size(cache_, file);
            missing = rest > UINT64_MAX - missing ? UINT64_MAX : missing + rest;
        }
        return missing;
    }

    void check_space() const {
        const std::uint64_t missing = missing_bytes();
        std::error_code code;
        const fs::space_info space = fs::space(cache_.folder(), code);
        if (code || missing <= space.available) return;
        throw ResourceError(fmt::format(
            "{}: {} needs {:.1f} GB more, but {:.1f} GB are free; free "
            "some space, or set HF_HUB_CACHE to a folder elsewhere",
            request_.cache.string(), request_.repository, static_cast<double>(missing) / 1e9,
            static_cast<double>(space.available) / 1e9));
    }

    void download() {
        constexpr double megabyte = 1e6;
        std::uint64_t total = 0;
        for (const RemoteFile& file : files_)
            total += file.size;
        const std::uint64_t missing = missing_bytes();
        downloaded_ += missing;
        const bool all_there = std::all_of(
            files_.begin(), files_.end(), [&](const auto& file) { return has_blob(cache_, file); });
        if (all_there) return;
        const auto megabytes = [&](std::uint64_t bytes) {
            return static_cast<std::int64_t>(static_cast<double>(bytes) / megabyte + 0.5);
        };
        Progress progress("pull, MB", megabytes(total), megabytes(total - missing));
        std::uint64_t done = 0;
        for (const RemoteFile& file : files_) {
            download_blob(client_, cache_, file, request_.retry, [&](std::uint64_t bytes) {
                progress.update(megabytes(done + bytes), file.path);
            });
            done += file.size;
            progress.update(megabytes(done), file.path);
        }
    }

    PullResult finish() {
        const FileLock lock(cache_.lock("snapshot"));
        PullResult result;
        for (const RemoteFile& file : files_) {
            cache_.link(commit_, file.path, file.etag);
            result.files.push_back(file.path);
            result.bytes += file.size;
        }
        cache_.set_ref(request_.revision, commit_);
        result.folder = cache_.snapshot(commit_);
        result.commit = commit_;
        result.downloaded_bytes = downloaded_;
        return result;
    }

    const PullRequest& request_;
    HttpClient client_;
    CachedRepository cache_;
    std::string commit_;
    std::vector<std::string> paths_;
    std::vector<RemoteFile> files_;
    std::uint64_t downloaded_ = 0;
};

/// Returns the token as huggingface_hub finds it: from the environment, else from its file.
std::string find_token() {
    std::string token;
    if (const char* set = std::getenv("HF_TOKEN"); set && *set) {
        token = set;
    } else if (const fs::path file = hub_home_folder() / "token"; fs::is_regular_file(file)) {
        token = read_text(file);
    }
    std::erase_if(token, [](char c) { return c == '\n' || c == '\r' || c == ' '; });
    return token;
}

}  // namespace

PullRequest PullRequest::from_environment() {
    PullRequest request;
    if (const char* endpoint = std::getenv("HF_ENDPOINT"); endpoint && *endpoint)
        request.endpoint = endpoint;
    while (request.endpoint.ends_with('/'))
        request.endpoint.pop_back();
    request.token = find_token();
    request.cache = hub_cache_folder();
    return request;
}

PullResult pull(const PullRequest& request) {
    try {
        return Pull(request).run();
    } catch (const Interrupted&) {
        throw Interrupted(fmt::format("while pulling {}; run the same command again to continue",
                                      request.repository));
    }
}

}  // namespace item3d
