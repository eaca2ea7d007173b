// The provenance claim of a model or an image that item3d edited or reconstructed. It contains the
// sentences, the prior, the input, and hashes of the output.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// One edit by sentences, or one reconstruction from photographs. Empty members are not written.
struct EditClaim {
    std::string from, to;             ///< sentences of the edit
    std::string method;               ///< for example "item3d, rdl"
    std::string prior, prior_hash;    ///< name of the prior's folder, and its hash_of_weights()
    std::string input, input_sha256;  ///< file name and SHA-256 of the edited model
    std::string date;                 ///< start of the edit: utc_date()
    std::string version;              ///< version of item3d that made the edit
    std::string strength;             ///< strength of a layer: "0.5", or "1:roughness,metallic"
    std::string variant;              ///< name of the variant in a file with variants
    std::string photographs;          ///< number of photographs of a reconstruction
    std::string source_type;          ///< IPTC code of a reconstruction

    bool operator==(const EditClaim&) const = default;
};

/// True for a reconstruction; no generative model takes part in one.
bool is_reconstruction(const EditClaim& edit);

void to_json(nlohmann::json& json, const EditClaim& edit);
/// Reads members that are strings. A missing member, or one of another type, becomes empty.
void from_json(const nlohmann::json& json, EditClaim& edit);

/// An image that an edit wrote.
struct ImageClaim {
    std::string image;   ///< index in the document's images; empty for the file itself
    std::string name;    ///< name of the image; may be empty
    std::string sha256;  ///< image_sha256()

    bool operator==(const ImageClaim&) const = default;
};

void to_json(nlohmann::json& json, const ImageClaim& image);
void from_json(const nlohmann::json& json, ImageClaim& image);

/// Returns a claim with "program", "version", "edits", "images" and, for a model,
/// "document_sha256". The claim consists of objects, lists and strings only, because XMP and
/// JSON-LD preserve these. Text that XML cannot hold (control characters, invalid UTF-8) is
/// replaced.
nlohmann::json make_claim(const std::vector<EditClaim>& edits,
                          const std::vector<ImageClaim>& images,
                          const std::string& document_sha256 = "");

/// Returns the edits of a claim that was read from a file; empty if it has none or is not an
/// object.
std::vector<EditClaim> edits_of(const nlohmann::json& claim);
std::vector<ImageClaim> images_of(const nlohmann::json& claim);

/// Returns `earlier`, followed by the members of `now` that `earlier` does not contain.
std::vector<EditClaim> join_edits(std::vector<EditClaim> earlier,
                                  const std::vector<EditClaim>& now);

/// Returns the latest date of the edits; empty if none has one.
std::string date_of(const std::vector<EditClaim>& edits);

/// Returns the signed form of a claim: its canonical JSON (RFC 8785) without the signature.
std::string canonical_claim(nlohmann::json claim);

}  // namespace item3d
