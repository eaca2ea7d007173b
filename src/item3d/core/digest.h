// Checksums: SHA-256, and the SHA-1 that git gives a file.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace item3d {

enum class DigestKind {
    none,
    /// SHA-1 of "blob SIZE\0" and the bytes: how the hub names small files.
    git_blob,
    /// How the hub names large files (Git LFS).
    sha256
};

/// What kind of checksum an entity tag of the hub is: 64 hexadecimal digits, 40, or neither.
DigestKind digest_kind(const std::string& etag);

/// A checksum of bytes that come piece by piece.
class Digest {
  public:
    /// size: how many bytes there will be; a git_blob begins with it.
    Digest(DigestKind kind, std::uint64_t size);
    ~Digest();
    Digest(Digest&&) noexcept;
    Digest& operator=(Digest&&) noexcept;

    void update(std::span<const std::uint8_t> bytes);
    /// Lower-case hexadecimal; "" for DigestKind::none. Ends the computation.
    std::string finish();

  private:
    struct Context;
    std::unique_ptr<Context> context_;  ///< null for DigestKind::none
};

/// SHA-256 in lower-case hexadecimal.
std::string sha256(std::span<const std::uint8_t> bytes);
std::string sha256(std::string_view text);

}  // namespace item3d
