// Provenance claim of a reconstructed model.
#pragma once

#include "item3d/provenance/provenance.h"
#include "item3d/reconstruct/reconstruct.h"

#include <string>

namespace item3d {

/// Returns the IPTC digital source type for a model of these views. It is the code of generative
/// editing if an image's XMP names a generative model. Otherwise it is empty if some images may not
/// be photographs, that is, if the layout is NeRF-synthetic, which contains renders, or if an
/// image's XMP names another source. Otherwise it is the code of computational capture.
std::string source_type_of(const Dataset& dataset);

/// Returns a claim with the number and the hash of the training images, the date and the request's
/// key. It is empty if the request omits provenance. Reads the images' files. Throws InputError if
/// a file is missing.
Provenance provenance_of(const ReconstructRequest& request, const Dataset& dataset,
                         const std::string& begun);

}  // namespace item3d
