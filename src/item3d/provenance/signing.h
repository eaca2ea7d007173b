// Ed25519 signatures of claims, with keys of the user's (RFC 8032; PEM as OpenSSL writes it).
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <string>

namespace item3d {

/// A private key: `openssl genpkey -algorithm ed25519 -out KEY.pem`.
class SigningKey {
  public:
    /// Throws InputError for a file that is none: another kind of key, a public or an encrypted
    /// one.
    static SigningKey load(const std::filesystem::path& path);

    /// Writes "public_key" and "signature" (both base64) into the claim, which is then signed with
    /// all that is in it.
    void sign(nlohmann::json& claim) const;

  private:
    explicit SigningKey(std::shared_ptr<void> key) : key_(std::move(key)) {}
    std::shared_ptr<void> key_;
};

/// Base64 of the 32 bytes of a public key, as `openssl pkey -in KEY.pem -pubout` writes it; of a
/// private key's file, that of its public one. Throws InputError.
std::string load_public_key(const std::filesystem::path& path);

enum class SignatureState {
    none,    ///< the claim has no signature
    valid,   ///< of the key that the claim names, over the claim as it stands
    invalid  ///< not over this claim: something of it was changed
};

/// Of the signature by the claim's own "public_key".
SignatureState signature_state(const nlohmann::json& claim);

/// The claim's "public_key"; empty where it has none.
std::string public_key_of(const nlohmann::json& claim);

}  // namespace item3d
