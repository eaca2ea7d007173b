// Tests of the source type that a reconstructed model claims.
#include "item3d/io/image/png.h"
#include "item3d/provenance/image_packet.h"
#include "item3d/provenance/xmp_names.h"
#include "item3d/reconstruct/outputs/reconstruction_claim.h"
#include "tests/support/reconstruct.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Returns an image with a packet of its own that has this IPTC source type, or without a packet if
/// `type` is empty.
Photograph photograph_of(const fs::path& folder, const std::string& type) {
    Photograph view;
    view.file = folder / ("picture_" + type + ".png");
    Bytes png = encode_png(testing::disk_image(4, 4), 8);
    if (!type.empty())
        png =
            with_packet(png,
                        "<x:xmpmeta xmlns:x='adobe:ns:meta/'><rdf:RDF "
                        "xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'><rdf:Description "
                        "xmlns:i='http://iptc.org/std/Iptc4xmpExt/2008-02-29/' "
                        "i:DigitalSourceType='http://cv.iptc.org/newscodes/digitalsourcetype/" +
                            type + "'/></rdf:RDF></x:xmpmeta>");
    write_atomically(view.file, std::span<const std::uint8_t>(png));
    return view;
}

TEST(ReconstructionClaim, IsACaptureUnlessImagesSayOtherwise) {
    const fs::path folder = testing::fresh_folder("source_type");
    const auto type_of = [&](DatasetKind kind, const std::vector<std::string>& types) {
        Dataset dataset;
        dataset.kind = kind;
        for (const std::string& type : types)
            dataset.train.push_back(photograph_of(folder, type));
        return source_type_of(dataset);
    };
    EXPECT_EQ(type_of(DatasetKind::colmap, {"", "digitalCapture", "negativeFilm"}),
              xmp::computational_capture);
    EXPECT_EQ(type_of(DatasetKind::nerfstudio, {""}), xmp::computational_capture);
    EXPECT_EQ(type_of(DatasetKind::nerf_synthetic, {""}), "");
    EXPECT_EQ(type_of(DatasetKind::llff, {"", "digitalCreation"}), "");
    for (const char* type : {"trainedAlgorithmicMedia", "compositeWithTrainedAlgorithmicMedia"})
        EXPECT_EQ(type_of(DatasetKind::colmap, {"", type, "digitalCapture"}), xmp::edited_by_model);
}

TEST(ReconstructionClaim, NamesThePhotographsAndChangesWithThem) {
    const fs::path folder = testing::fresh_folder("claim_of_pictures");
    Dataset dataset;
    dataset.kind = DatasetKind::colmap;
    dataset.train = {photograph_of(folder, ""), photograph_of(folder, "digitalCapture")};
    ReconstructRequest request;
    request.dataset = folder / "";
    const EditClaim claim = provenance_of(request, dataset, "2026-11-27T15:04:05Z").edits.at(0);
    EXPECT_EQ(claim.input, folder.filename().string());
    EXPECT_EQ(claim.photographs, "2");
    EXPECT_EQ(claim.source_type, xmp::computational_capture);
    photograph_of(folder, "print");
    dataset.train[1].file = folder / "picture_print.png";
    EXPECT_NE(provenance_of(request, dataset, "").edits.at(0).input_sha256, claim.input_sha256);
    request.says_provenance = false;
    EXPECT_TRUE(provenance_of(request, dataset, "").edits.empty());
}

}  // namespace
}  // namespace item3d
