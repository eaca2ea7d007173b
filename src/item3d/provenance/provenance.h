// Provenance to be written into output files.
#pragma once

#include "item3d/provenance/claim.h"
#include "item3d/provenance/signing.h"

#include <memory>
#include <vector>

namespace item3d {

struct Provenance {
    std::vector<EditClaim> edits;           ///< if empty, no claim is written
    std::shared_ptr<const SigningKey> key;  ///< if null, claims are not signed
};

}  // namespace item3d
