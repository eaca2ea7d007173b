// Reading and verification of a file's provenance claim.
#pragma once

#include "item3d/provenance/packet_metadata.h"
#include "item3d/provenance/signing.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

enum class ContentState { same, changed, missing };

/// Present state of an image whose hash is in a claim.
struct CheckedImage {
    ImageClaim image;
    ContentState state = ContentState::same;
};

struct FileProvenance {
    PacketMetadata metadata;           ///< of the asset's or image's packet
    std::string copyright, generator;  ///< of a glTF's asset
    std::vector<CheckedImage> images;
    ContentState document = ContentState::same;  ///< glTF only: all but the claimed images
    SignatureState signature = SignatureState::none;

    bool has_claim() const { return metadata.claim.is_object(); }
    /// True if images, document and signature match the claim.
    bool is_unchanged() const;
};

/// Reads a .glb, .vrm or .gltf, or an image. Throws InputError for files of other formats, and for
/// unreadable models.
FileProvenance read_provenance(const std::filesystem::path& path);

/// Returns "claim" (null: none), "source_type", "creator", "rights", "usage_terms", "copyright",
/// "generator", "problem", "images" (with "state"), "document" and "signature", in words.
nlohmann::json provenance_json(const FileProvenance& provenance);

}  // namespace item3d
