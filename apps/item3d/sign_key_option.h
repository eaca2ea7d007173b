// The option --sign-key, which gives the key that signs provenance claims.
#pragma once

#include "item3d/provenance/signing.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

namespace item3d {

struct SignKeyOption {
    std::filesystem::path path;  ///< empty: no signature

    /// Returns the key; null if there is no path. Throws InputError for an invalid key file.
    std::shared_ptr<const SigningKey> load() const {
        return path.empty() ? nullptr : std::make_shared<const SigningKey>(SigningKey::load(path));
    }
};

inline void add_sign_key(CLI::App& command, SignKeyOption& option) {
    command
        .add_option("--sign-key", option.path,
                    "Ed25519 private key in PEM to sign the output with (docs/provenance.md)")
        ->type_name("FILE");
}

}  // namespace item3d
