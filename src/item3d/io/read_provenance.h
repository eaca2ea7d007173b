// What a file says of how it came to be, and whether it is still what that was said of.
#pragma once

#include "item3d/provenance/packet_facts.h"
#include "item3d/provenance/signing.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

enum class ContentState { same, changed, missing };

/// An image that a claim has the hash of, as it is now.
struct CheckedImage {
    ImageClaim image;
    ContentState state = ContentState::same;
};

struct FileProvenance {
    PacketFacts facts;                 ///< of the asset's packet, or the image's
    std::string copyright, generator;  ///< of a glTF's asset
    std::vector<CheckedImage> images;
    ContentState document = ContentState::same;  ///< of a glTF: all but those images
    SignatureState signature = SignatureState::none;

    bool has_claim() const { return facts.claim.is_object(); }
    /// Whether images, document and signature are what the claim says.
    bool is_unchanged() const;
};

/// Reads a .glb, .vrm or .gltf, or an image. Throws InputError for other files, and for models that
/// cannot be read.
FileProvenance read_provenance(const std::filesystem::path& path);

/// "claim" (null: none), "source_type", "creator", "rights", "usage_terms", "copyright",
/// "generator", "problem", "images" (with "state"), "document" and "signature", in words.
nlohmann::json provenance_json(const FileProvenance& provenance);

}  // namespace item3d
