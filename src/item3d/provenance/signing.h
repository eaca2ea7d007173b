// Ed25519 signatures of claims with the user's keys (RFC 8032; PEM as written by OpenSSL).
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <string>

namespace item3d {

/// A private key, as `openssl genpkey -algorithm ed25519 -out KEY.pem` makes it.
class SigningKey {
  public:
    /// Reads a PEM file. Throws InputError for anything else, such as another kind of key, a public
    /// key, or an encrypted key.
    static SigningKey load(const std::filesystem::path& path);

    /// Adds "public_key" and "signature" (both base64) to the claim, which must be complete before.
    void sign(nlohmann::json& claim) const;

  private:
    explicit SigningKey(std::shared_ptr<void> key) : key_(std::move(key)) {}
    std::shared_ptr<void> key_;
};

/// Returns the 32 bytes of a public key in base64. The file is one that `openssl pkey -in KEY.pem
/// -pubout` writes, or the file of the private key. Throws InputError.
std::string load_public_key(const std::filesystem::path& path);

enum class SignatureState {
    none,    ///< the claim has no signature
    valid,   ///< signed by the key that the claim names, and unchanged since
    invalid  ///< the claim was changed after signing
};

/// Returns the state of the signature under the claim's own "public_key".
SignatureState signature_state(const nlohmann::json& claim);

/// Returns the claim's "public_key", or "".
std::string public_key_of(const nlohmann::json& claim);

}  // namespace item3d
