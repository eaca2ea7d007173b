#include "item3d/reconstruct/outputs/reconstruction_claim.h"

#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/core/version.h"
#include "item3d/provenance/image_packet.h"
#include "item3d/provenance/xmp.h"
#include "item3d/provenance/xmp_names.h"

#include <algorithm>
#include <array>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Suffixes of the codes of media sampled from real life.
constexpr std::array<std::string_view, 5> captures = {"/digitalCapture", "/computationalCapture",
                                                      "/negativeFilm", "/positiveFilm", "/print"};
/// Suffixes of the codes of media that a generative model made or edited.
constexpr std::array<std::string_view, 2> generated = {"/trainedAlgorithmicMedia",
                                                       "/compositeWithTrainedAlgorithmicMedia"};

bool ends_with_any(const std::string& text, const auto& ends) {
    return std::any_of(ends.begin(), ends.end(),
                       [&](std::string_view end) { return text.ends_with(end); });
}

/// Returns the source type in an image's XMP. Returns an empty text if the XMP names none, or if
/// the image cannot be read any more.
std::string own_source_type(const fs::path& image) {
    try {
        const auto packet = find_packet(read_bytes(image));
        return packet ? read_xmp(*packet).source_type : "";
    } catch (const InputError&) {
        return "";
    }
}

/// Returns the SHA-256 of the files' hashes, in the order of the views.
std::string hash_of_files(const std::vector<Photograph>& views) {
    std::string hashes;
    for (const Photograph& view : views)
        hashes += sha256(read_bytes(view.file));
    return sha256(hashes);
}

std::string name_of(const ReconstructRequest& request) {
    const fs::path& path =
        request.dataset_options.images.empty() ? request.dataset : request.dataset_options.images;
    const fs::path whole = fs::absolute(path).lexically_normal();
    return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

}  // namespace

std::string source_type_of(const Dataset& dataset) {
    std::string type =
        dataset.kind == DatasetKind::nerf_synthetic ? "" : std::string(xmp::computational_capture);
    for (const Photograph& view : dataset.train) {
        const std::string own = own_source_type(view.file);
        if (own.empty() || ends_with_any(own, captures)) continue;
        if (ends_with_any(own, generated)) {
            warn(view.file.string() + ": its XMP says that a generative model made or edited it; " +
                 "this is recorded in the model");
            return std::string(xmp::edited_by_model);
        }
        type.clear();
    }
    return type;
}

Provenance provenance_of(const ReconstructRequest& request, const Dataset& dataset,
                         const std::string& begun) {
    if (!request.says_provenance) return {};
    EditClaim claim;
    claim.method = "item3d, reconstruct";
    claim.photographs = std::to_string(dataset.train.size());
    claim.source_type = source_type_of(dataset);
    claim.input = name_of(request);
    claim.input_sha256 = hash_of_files(dataset.train);
    claim.date = begun;
    claim.version = version();
    return {{claim}, request.sign_key};
}

}  // namespace item3d
