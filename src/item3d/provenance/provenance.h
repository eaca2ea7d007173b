// What a file that is written says of how it came to be.
#pragma once

#include "item3d/provenance/claim.h"
#include "item3d/provenance/signing.h"

#include <memory>
#include <vector>

namespace item3d {

struct Provenance {
    std::vector<EditClaim> edits;           ///< empty: nothing is said
    std::shared_ptr<const SigningKey> key;  ///< null: claims are not signed
};

}  // namespace item3d
