// The claim of a model or an image that item3d edited or reconstructed: by which sentences, with
// which prior, of which input, and the hashes of what it wrote.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// One edit by sentences, or a reconstruction from photographs. Empty members are not written.
struct EditClaim {
    std::string from, to;             ///< the sentences
    std::string method;               ///< as "item3d, rdl"
    std::string prior, prior_hash;    ///< name of its folder; hash_of_weights()
    std::string input, input_sha256;  ///< file name and SHA-256 of the model that was edited
    std::string date;                 ///< when it began: utc_date()
    std::string version;              ///< of the item3d that made it
    std::string strength;             ///< of a layer: "0.5", or "1:roughness,metallic"
    std::string variant;              ///< name of the look in a file of several
    std::string photographs;          ///< of a reconstruction: how many it was computed from
    std::string source_type;          ///< of a reconstruction: the IPTC's code for the result

    bool operator==(const EditClaim&) const = default;
};

/// Whether it is a reconstruction, which no generative model takes part in.
bool is_reconstruction(const EditClaim& edit);

void to_json(nlohmann::json& json, const EditClaim& edit);
/// Takes text alone; what is missing or something else becomes empty.
void from_json(const nlohmann::json& json, EditClaim& edit);

/// An image that an edit wrote.
struct ImageClaim {
    std::string image;   ///< its index among the document's; empty: the file itself
    std::string name;    ///< of the image; may be empty
    std::string sha256;  ///< image_sha256()

    bool operator==(const ImageClaim&) const = default;
};

void to_json(nlohmann::json& json, const ImageClaim& image);
void from_json(const nlohmann::json& json, ImageClaim& image);

/// "program", "version", "edits", "images" and, of a model, "document_sha256": JSON of objects,
/// lists and text alone, of which XMP and JSON-LD keep every value. Text that XML cannot hold
/// (control characters, bytes that are no UTF-8) is replaced.
nlohmann::json make_claim(const std::vector<EditClaim>& edits,
                          const std::vector<ImageClaim>& images,
                          const std::string& document_sha256 = "");

/// The edits of a claim as it was read; empty where it has none or is no object.
std::vector<EditClaim> edits_of(const nlohmann::json& claim);
std::vector<ImageClaim> images_of(const nlohmann::json& claim);

/// `earlier`, then those of `now` that are not among them.
std::vector<EditClaim> join_edits(std::vector<EditClaim> earlier,
                                  const std::vector<EditClaim>& now);

/// The latest date of the edits; empty where none has one.
std::string date_of(const std::vector<EditClaim>& edits);

/// The canonical JSON (RFC 8785) of a claim without its signature: what is signed.
std::string canonical_claim(nlohmann::json claim);

}  // namespace item3d
