// Claims in the images that an edit writes. Internal to io.
#pragma once

#include "item3d/io/save.h"
#include "item3d/provenance/provenance.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Puts an XMP packet into every encoded image of the edit that can hold one, with what the packet
/// of the source's image says (its author, licence and edits). Nothing where there are no edits.
void put_claims(const Provenance& provenance, const Model& model, const ModelEdit& edit);

}  // namespace item3d
