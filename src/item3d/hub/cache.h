// The cache of huggingface_hub, read and written in its layout:
//
//   CACHE/models--ORG--NAME/blobs/ETAG               the files' bytes
//                           snapshots/COMMIT/PATH    relative links to them
//                           refs/REVISION            the commit of a branch or tag
//   CACHE/.locks/models--ORG--NAME/ETAG.lock         held while a blob is written
//
// https://huggingface.co/docs/huggingface_hub/guides/manage-cache
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

/// A repository's name as the user gives it, "org/name" or "org/name@revision".
struct RepositoryName {
    std::string name;      ///< "org/name"
    std::string revision;  ///< "" if not given, which means the branch "main"

    /// Returns no value for an invalid name.
    static std::optional<RepositoryName> parse(const std::string& text);
    std::string revision_or_main() const { return revision.empty() ? "main" : revision; }
};

/// True for a branch, tag or commit that is safe as part of a path.
bool is_revision(const std::string& text);
/// True for 40 hexadecimal digits.
bool is_commit(const std::string& text);
/// True for a path that stays inside its folder: it is relative and has no ".." and no backslash.
bool stays_inside(const std::string& path);

/// Returns $HF_HUB_CACHE, else $HF_HOME/hub, else $XDG_CACHE_HOME/huggingface/hub, else
/// ~/.cache/huggingface/hub.
std::filesystem::path hub_cache_folder();
/// Returns the folder in which huggingface_hub stores the token: $HF_HOME, else
/// $XDG_CACHE_HOME/huggingface, else ~/.cache/huggingface.
std::filesystem::path hub_home_folder();

/// One repository in a cache. The repository may not exist there yet.
class CachedRepository {
  public:
    CachedRepository(std::filesystem::path cache, const std::string& name);

    const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path blob(const std::string& etag) const { return folder_ / "blobs" / etag; }
    /// Returns the path of the lock file for a blob, or for another name.
    std::filesystem::path lock(const std::string& name) const;
    std::filesystem::path snapshot(const std::string& commit) const {
        return folder_ / "snapshots" / commit;
    }
    std::filesystem::path ref(const std::string& revision) const {
        return folder_ / "refs" / revision;
    }
    bool exists() const { return std::filesystem::is_directory(folder_); }

    /// Returns the snapshot of `revision`, in which every link resolves to a file. Throws
    /// InputError that names the missing reference, folder or link.
    std::filesystem::path find_snapshot(const std::string& revision) const;
    /// Makes snapshots/COMMIT/PATH a relative link to the blob, atomically. Only one caller at a
    /// time may call this function or set_ref().
    void link(const std::string& commit, const std::string& path, const std::string& etag) const;
    /// Records the commit of `revision`.
    void set_ref(const std::string& revision, const std::string& commit) const;

  private:
    std::filesystem::path cache_;
    std::filesystem::path folder_;
    std::string name_;
};

}  // namespace item3d
