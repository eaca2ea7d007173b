// Provenance claim of a reconstructed model.
#pragma once

#include "item3d/provenance/provenance.h"
#include "item3d/reconstruct/reconstruct.h"

#include <string>

namespace item3d {

/// Returns the IPTC code of a model of these views: a capture, computed from photographs. Empty if
/// the images may not be photographs (NeRF-synthetic is a layout of renders, or an image's XMP
/// names another source); the code of generative editing if an image's XMP names a generative
/// model.
std::string source_type_of(const Dataset& dataset);

/// Returns the images with their hashes, the date, and the request's key; empty if the request
/// omits provenance. Reads the images' files. Throws InputError for missing ones.
Provenance provenance_of(const ReconstructRequest& request, const Dataset& dataset,
                         const std::string& begun);

}  // namespace item3d
