#include "item3d/io/read_provenance.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/io/gltf/claims.h"
#include "item3d/io/image/formats.h"
#include "item3d/io/text.h"
#include "item3d/provenance/image_packet.h"
#include "item3d/provenance/xmp.h"

#include <algorithm>

namespace item3d {
namespace {

std::string asset_text(const Json& root, const char* key) {
    if (!root.contains("asset") || !root["asset"].is_object()) return "";
    const auto found = root["asset"].find(key);
    return found != root["asset"].end() && found->is_string() ? found->get<std::string>() : "";
}

FileProvenance of_document(const SourceDocument& document) {
    FileProvenance provenance;
    provenance.metadata = read_asset_packet(document.json);
    provenance.copyright = asset_text(document.json, "copyright");
    provenance.generator = asset_text(document.json, "generator");
    if (!provenance.has_claim()) return provenance;
    const std::vector<ImageClaim> claimed = images_of(provenance.metadata.claim);
    const std::vector<std::string> hashes = image_hashes(document);
    for (const ImageClaim& image : claimed) {
        std::string now;
        for (std::size_t i = 0; i < hashes.size(); ++i)
            if (image.image == std::to_string(i)) now = hashes[i];
        provenance.images.push_back({image, now.empty()           ? ContentState::missing
                                            : now == image.sha256 ? ContentState::same
                                                                  : ContentState::changed});
    }
    const nlohmann::json& claim = provenance.metadata.claim;
    const bool is_same = claim.contains("document_sha256") &&
                         claim["document_sha256"] == document_sha256(document, claimed);
    provenance.document = is_same ? ContentState::same : ContentState::changed;
    return provenance;
}

FileProvenance of_image(const Bytes& bytes) {
    FileProvenance provenance;
    const auto packet = find_packet(bytes);
    if (!packet) return provenance;
    provenance.metadata = read_xmp(*packet);
    if (!provenance.has_claim()) return provenance;
    const std::string now = image_sha256(bytes);
    std::vector<ImageClaim> claimed = images_of(provenance.metadata.claim);
    // A claim that lists no image gets an empty entry, which this image cannot match.
    if (claimed.empty()) claimed.emplace_back();
    for (const ImageClaim& image : claimed)
        provenance.images.push_back(
            {image, image.sha256 == now ? ContentState::same : ContentState::changed});
    return provenance;
}

const char* word_of(ContentState state) {
    return state == ContentState::same      ? "unchanged"
           : state == ContentState::changed ? "changed"
                                            : "missing";
}

const char* word_of(SignatureState state) {
    return state == SignatureState::none    ? "none"
           : state == SignatureState::valid ? "valid"
                                            : "invalid";
}

}  // namespace

bool FileProvenance::is_unchanged() const {
    return document == ContentState::same && signature != SignatureState::invalid &&
           std::all_of(images.begin(), images.end(),
                       [](const CheckedImage& image) { return image.state == ContentState::same; });
}

FileProvenance read_provenance(const std::filesystem::path& path) {
    const Bytes bytes = read_bytes(path);
    const bool is_glb = bytes.size() >= 4 && std::equal(bytes.begin(), bytes.begin() + 4, "glTF");
    FileProvenance provenance;
    if (is_glb || to_lower(path.extension().string()) == ".gltf")
        provenance = of_document(*parse_gltf(path, bytes));
    else if (detect_image_format(bytes) != ImageFormat::unknown)
        provenance = of_image(bytes);
    else
        throw InputError(path.string(), "is neither a glTF nor an image",
                         "choose a .glb, .gltf, PNG, JPEG, WebP or KTX2 file");
    provenance.signature = signature_state(provenance.metadata.claim);
    return provenance;
}

nlohmann::json provenance_json(const FileProvenance& provenance) {
    const PacketMetadata& metadata = provenance.metadata;
    nlohmann::json out{{"claim", provenance.has_claim() ? metadata.claim : nlohmann::json()},
                       {"source_type", metadata.source_type},
                       {"creator", metadata.creator},
                       {"rights", metadata.rights},
                       {"usage_terms", metadata.usage_terms},
                       {"copyright", provenance.copyright},
                       {"generator", provenance.generator},
                       {"problem", metadata.problem},
                       {"images", nlohmann::json::array()},
                       {"signature", word_of(provenance.signature)},
                       {"unchanged", provenance.has_claim() && provenance.is_unchanged()}};
    // Claims in images contain no hash of a document.
    if (metadata.claim.contains("document_sha256")) out["document"] = word_of(provenance.document);
    for (const CheckedImage& checked : provenance.images) {
        nlohmann::json image = checked.image;
        image["state"] = word_of(checked.state);
        out["images"].push_back(std::move(image));
    }
    return out;
}

}  // namespace item3d
