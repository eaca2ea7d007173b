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
    PacketMetadata metadata;           ///< from the XMP packet of the asset or image
    std::string copyright, generator;  ///< from a glTF's asset
    std::vector<CheckedImage> images;
    /// State of a glTF's content except the claimed images; `same` for an image.
    ContentState document = ContentState::same;
    SignatureState signature = SignatureState::none;

    bool has_claim() const { return metadata.claim.is_object(); }
    /// True if images, document and signature match the claim.
    bool is_unchanged() const;
};

/// Reads a .glb, .vrm or .gltf, or an image. Throws InputError for files of other formats, and for
/// unreadable models.
FileProvenance read_provenance(const std::filesystem::path& path);

/// Returns an object with "claim" (null if there is none), "source_type", "creator", "rights",
/// "usage_terms", "copyright", "generator", "problem", "images" (each with "state"), "document"
/// (only if the claim has its hash), "signature" and "unchanged". States are words.
nlohmann::json provenance_json(const FileProvenance& provenance);

}  // namespace item3d
