// The claim of a reconstructed model.
#pragma once

#include "item3d/provenance/provenance.h"
#include "item3d/reconstruct/reconstruct.h"

#include <string>

namespace item3d {

/// The IPTC's code for a model of these views: a capture, which is merged from photographs by
/// computation. Empty where the pictures may be no photographs (NeRF-synthetic is a layout of
/// rendered ones, or a picture's own XMP names another source); the code for generative editing
/// where a picture's own XMP names a generative model.
std::string source_type_of(const Dataset& dataset);

/// Pictures with their hash, the date, and the request's key; nothing where the request is silent.
/// Reads the pictures' files. Throws InputError for those that are gone.
Provenance provenance_of(const ReconstructRequest& request, const Dataset& dataset,
                         const std::string& begun);

}  // namespace item3d
