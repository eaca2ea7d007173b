#include "item3d/provenance/signing.h"
#include "tests/fuzz/mutate.h"

#include <nlohmann/json.hpp>

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<1>(data, size, maximum, seed))

/// Reads the file of a key, or a claim with a signature, as the first byte says.
ITEM3D_FUZZ_TARGET(signed_claim, data, size) {
    using namespace item3d;
    if (size == 0) return 0;
    return fuzz::read_or_refuse([&] {
        const std::string text = fuzz::as_text(data + 1, size - 1);
        if (data[0] % 2 == 0) {
            const auto file = fuzz::as_file("key.pem", text);
            load_public_key(file);
            nlohmann::json claim = {{"edits", nlohmann::json::array()}};
            SigningKey::load(file).sign(claim);
            ITEM3D_CHECK(signature_state(claim) == SignatureState::valid, "is what was signed");
        } else if (const auto claim = nlohmann::json::parse(text, nullptr, false);
                   claim.is_object()) {
            signature_state(claim);
            public_key_of(claim);
        }
    });
}
