// The cache that huggingface_hub keeps, read and written in its layout:
//
//   CACHE/models--ORG--NAME/blobs/ETAG               the files' bytes
//                           snapshots/COMMIT/PATH    relative links to them
//                           refs/REVISION            the commit that a branch or tag meant
//   CACHE/.locks/models--ORG--NAME/ETAG.lock         held while a blob is written
//
// https://huggingface.co/docs/huggingface_hub/guides/manage-cache
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

/// "org/name" or "org/name@revision".
struct RepositoryName {
    std::string name;      ///< "org/name"
    std::string revision;  ///< "" where none was given: the branch "main"

    /// Nothing when the text is no such name.
    static std::optional<RepositoryName> parse(const std::string& text);
    std::string revision_or_main() const { return revision.empty() ? "main" : revision; }
};

/// True for a branch, tag or commit that may become part of a path.
bool is_revision(const std::string& text);
/// 40 hexadecimal digits.
bool is_commit(const std::string& text);
/// True for a path that stays in the folder that it is put into: relative, no "..", no backslash.
bool stays_inside(const std::string& path);

/// $HF_HUB_CACHE, else $HF_HOME/hub, else $XDG_CACHE_HOME/huggingface/hub, else
/// ~/.cache/huggingface/hub.
std::filesystem::path hub_cache_folder();
/// $HF_HOME, else $XDG_CACHE_HOME/huggingface, else ~/.cache/huggingface: where the token lies.
std::filesystem::path hub_home_folder();

/// One repository in a cache; it need not be there yet.
class CachedRepository {
  public:
    CachedRepository(std::filesystem::path cache, const std::string& name);

    const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path blob(const std::string& etag) const { return folder_ / "blobs" / etag; }
    /// Of a blob, or of anything else that has a name.
    std::filesystem::path lock(const std::string& name) const;
    std::filesystem::path snapshot(const std::string& commit) const {
        return folder_ / "snapshots" / commit;
    }
    std::filesystem::path ref(const std::string& revision) const {
        return folder_ / "refs" / revision;
    }
    bool exists() const { return std::filesystem::is_directory(folder_); }

    /// The snapshot of `revision`, all of whose links lead to a file. Throws InputError that names
    /// the reference, folder or link that is missing.
    std::filesystem::path find_snapshot(const std::string& revision) const;
    /// Makes snapshots/COMMIT/PATH a relative link to the blob, at once or not at all. Like
    /// set_ref() for one caller at a time.
    void link(const std::string& commit, const std::string& path, const std::string& etag) const;
    /// Remembers what `revision` meant.
    void set_ref(const std::string& revision, const std::string& commit) const;

  private:
    std::filesystem::path cache_;
    std::filesystem::path folder_;
    std::string name_;
};

}  // namespace item3d
