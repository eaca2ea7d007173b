// Provenance claims in the images that an edit writes. Internal to io.
#pragma once

#include "item3d/io/save.h"
#include "item3d/provenance/provenance.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Adds an XMP packet to every encoded image of the edit whose format supports it. The packet
/// includes the content of the source image's packet (its author, licence and edits). Does nothing
/// for an empty provenance.
void put_claims(const Provenance& provenance, const Model& model, const ModelEdit& edit);

}  // namespace item3d
