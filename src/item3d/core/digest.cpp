#include "item3d/core/digest.h"

#include "item3d/core/error.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>

namespace item3d {

DigestKind digest_kind(const std::string& etag) {
    const bool hexadecimal = std::all_of(etag.begin(), etag.end(), [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
    });
    if (hexadecimal && etag.size() == 64) return DigestKind::sha256;
    if (hexadecimal && etag.size() == 40) return DigestKind::git_blob;
    return DigestKind::none;
}

struct Digest::Context {
    std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> state{EVP_MD_CTX_new(),
                                                                  &EVP_MD_CTX_free};
};

Digest::Digest(DigestKind kind, std::uint64_t size) {
    if (kind == DigestKind::none) return;
    context_ = std::make_unique<Context>();
    const EVP_MD* method = kind == DigestKind::sha256 ? EVP_sha256() : EVP_sha1();
    if (EVP_DigestInit_ex(context_->state.get(), method, nullptr) != 1)
        throw ResourceError("the cryptography library cannot compute a checksum");
    if (kind == DigestKind::git_blob) {
        const std::string header = fmt::format("blob {}", size);
        // The checksum includes the terminating zero of the header.
        EVP_DigestUpdate(context_->state.get(), header.c_str(), header.size() + 1);
    }
}

Digest::~Digest() = default;
Digest::Digest(Digest&&) noexcept = default;
Digest& Digest::operator=(Digest&&) noexcept = default;

void Digest::update(std::span<const std::uint8_t> bytes) {
    if (context_) EVP_DigestUpdate(context_->state.get(), bytes.data(), bytes.size());
}

std::string Digest::finish() {
    if (!context_) return "";
    std::array<unsigned char, EVP_MAX_MD_SIZE> value{};
    unsigned int length = 0;
    EVP_DigestFinal_ex(context_->state.get(), value.data(), &length);
    std::string text;
    for (unsigned int i = 0; i < length; ++i)
        text += fmt::format("{:02x}", value[i]);
    return text;
}

std::string sha256(std::span<const std::uint8_t> bytes) {
    Digest digest(DigestKind::sha256, bytes.size());
    digest.update(bytes);
    return digest.finish();
}

std::string sha256(std::string_view text) {
    return sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace item3d
