#include "item3d/provenance/signing.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/provenance/claim.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include <array>
#include <span>
#include <vector>

namespace item3d {
namespace {

constexpr std::size_t key_size = 32, signature_size = 64;

using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
using Context = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

constexpr const char* how_to_make =
    "make one with: openssl genpkey -algorithm ed25519 -out KEY.pem";
constexpr const char* how_to_export =
    "export one with: openssl pkey -in KEY.pem -pubout -out PUBLIC.pem";

std::string to_base64(std::span<const unsigned char> bytes) {
    std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
    const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(),
                                     static_cast<int>(bytes.size()));
    text.resize(static_cast<std::size_t>(size));
    return text;
}

/// Decodes exactly `size` bytes. Returns an empty list for anything else.
std::vector<unsigned char> from_base64(const std::string& text, std::size_t size) {
    if (text.size() != 4 * ((size + 2) / 3)) return {};
    std::vector<unsigned char> bytes(text.size() / 4 * 3);
    const int decoded =
        EVP_DecodeBlock(bytes.data(), reinterpret_cast<const unsigned char*>(text.data()),
                        static_cast<int>(text.size()));
    if (decoded < static_cast<int>(size)) return {};
    bytes.resize(size);
    // Padding and unused bits have several encodings. Only the encoding of to_base64() is accepted.
    return to_base64(bytes) == text ? bytes : std::vector<unsigned char>();
}

/// Password callback that prompts nobody.
int no_password(char*, int, int, void*) {
    return -1;
}

Key read_key(const std::string& pem, bool is_private) {
    const std::unique_ptr<BIO, decltype(&BIO_free)> file(
        BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())), &BIO_free);
    Key key(is_private ? PEM_read_bio_PrivateKey(file.get(), nullptr, no_password, nullptr)
                       : PEM_read_bio_PUBKEY(file.get(), nullptr, no_password, nullptr),
            &EVP_PKEY_free);
    ERR_clear_error();
    return key;
}

std::string read_pem(const std::filesystem::path& path, const char* hint) {
    constexpr std::size_t largest = 1 << 16;
    std::string pem = read_text(path);
    if (pem.size() > largest || pem.find("-----BEGIN ") == std::string::npos)
        throw InputError(path.string(), "is not a PEM key", hint);
    return pem;
}

void require_ed25519(const std::filesystem::path& path, const Key& key, const char* hint) {
    if (EVP_PKEY_get_id(key.get()) == EVP_PKEY_ED25519) return;
    const char* name = EVP_PKEY_get0_type_name(key.get());
    throw InputError(path.string(),
                     std::string("is not an Ed25519 key (") + (name ? name : "unknown") + ")",
                     hint);
}

std::string raw_public_key(EVP_PKEY* key) {
    std::array<unsigned char, key_size> bytes{};
    std::size_t size = bytes.size();
    ITEM3D_CHECK(EVP_PKEY_get_raw_public_key(key, bytes.data(), &size) == 1 && size == key_size,
                 "an Ed25519 key has a public key");
    return to_base64(bytes);
}

std::string text_of(const nlohmann::json& claim, const char* key) {
    if (!claim.is_object()) return "";
    const auto found = claim.find(key);
    return found != claim.end() && found->is_string() ? found->get<std::string>() : "";
}

std::span<const unsigned char> bytes_of(const std::string& text) {
    return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

}  // namespace

SigningKey SigningKey::load(const std::filesystem::path& path) {
    const std::string pem = read_pem(path, how_to_make);
    if (pem.find("ENCRYPTED") != std::string::npos)
        throw InputError(path.string(), "is encrypted with a password, which is not supported",
                         "write it without a password: openssl pkey -in KEY.pem -out PLAIN.pem");
    Key key = read_key(pem, true);
    if (!key) {
        if (read_key(pem, false))
            throw InputError(path.string(), "is a public key, but signing needs the private key",
                             how_to_make);
        throw InputError(path.string(), "is not a private key, or is damaged", how_to_make);
    }
    require_ed25519(path, key, how_to_make);
    return SigningKey(std::shared_ptr<void>(
        key.release(), [](void* owned) { EVP_PKEY_free(static_cast<EVP_PKEY*>(owned)); }));
}

void SigningKey::sign(nlohmann::json& claim) const {
    auto* key = static_cast<EVP_PKEY*>(key_.get());
    claim["public_key"] = raw_public_key(key);
    const std::string text = canonical_claim(claim);
    const Context context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
    std::array<unsigned char, signature_size> signature{};
    std::size_t size = signature.size();
    const bool is_signed = EVP_DigestSignInit(context.get(), nullptr, nullptr, nullptr, key) == 1 &&
                           EVP_DigestSign(context.get(), signature.data(), &size,
                                          bytes_of(text).data(), text.size()) == 1;
    if (!is_signed) throw ResourceError("the cryptography library cannot sign");
    claim["signature"] = to_base64({signature.data(), size});
}

std::string load_public_key(const std::filesystem::path& path) {
    const std::string pem = read_pem(path, how_to_export);
    if (pem.find("PRIVATE KEY-----") != std::string::npos)
        throw InputError(path.string(), "is a private key, expected a public key", how_to_export);
    const Key key = read_key(pem, false);
    if (!key) throw InputError(path.string(), "is not a public key, or is damaged", how_to_export);
    require_ed25519(path, key, how_to_export);
    return raw_public_key(key.get());
}

SignatureState signature_state(const nlohmann::json& claim) {
    const std::string text = text_of(claim, "signature");
    if (text.empty()) return SignatureState::none;
    const auto signature = from_base64(text, signature_size);
    const auto raw = from_base64(public_key_of(claim), key_size);
    if (signature.empty() || raw.empty()) return SignatureState::invalid;
    const Key key(EVP_PKEY_new_raw_public_key(EVP_PKEY_ED25519, nullptr, raw.data(), raw.size()),
                  &EVP_PKEY_free);
    const std::string signed_text = canonical_claim(claim);
    const Context context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
    const bool is_valid =
        key && EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, key.get()) == 1 &&
        EVP_DigestVerify(context.get(), signature.data(), signature.size(),
                         bytes_of(signed_text).data(), signed_text.size()) == 1;
    ERR_clear_error();
    return is_valid ? SignatureState::valid : SignatureState::invalid;
}

std::string public_key_of(const nlohmann::json& claim) {
    return text_of(claim, "public_key");
}

}  // namespace item3d
