// Checksums: SHA-256, and git's SHA-1 of a file.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace item3d {

enum class DigestKind {
    none,
    /// SHA-1 of "blob SIZE\0" and the bytes, which is the checksum of small files on the Hugging
    /// Face hub.
    git_blob,
    /// SHA-256, which is the checksum of large files (Git LFS) on the Hugging Face hub.
    sha256
};

/// Returns the kind of checksum in an HTTP entity tag of the Hugging Face hub: sha256 for 64
/// hexadecimal digits, git_blob for 40, else none.
DigestKind digest_kind(const std::string& etag);

/// Incremental checksum.
class Digest {
  public:
    /// size: total number of bytes, which DigestKind::git_blob needs in advance.
    Digest(DigestKind kind, std::uint64_t size);
    ~Digest();
    Digest(Digest&&) noexcept;
    Digest& operator=(Digest&&) noexcept;

    void update(std::span<const std::uint8_t> bytes);
    /// Returns the checksum in lower-case hexadecimal; "" for DigestKind::none. May be called only
    /// once.
    std::string finish();

  private:
    struct Context;
    std::unique_ptr<Context> context_;  ///< null for DigestKind::none
};

/// Returns SHA-256 in lower-case hexadecimal.
std::string sha256(std::span<const std::uint8_t> bytes);
std::string sha256(std::string_view text);

}  // namespace item3d
