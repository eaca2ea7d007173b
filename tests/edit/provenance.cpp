// Tests of the claims in an edit's provenance. The start date stays the same across interruptions
// and in all outputs.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/io/read_provenance.h"
#include "item3d/layers/layered_model.h"
#include "tests/support/edit.h"

namespace item3d {
namespace {

class ProvenanceTest : public testing::EditTest {
  protected:
    static void set_time(const char* seconds) { setenv("SOURCE_DATE_EPOCH", seconds, 1); }
    static EditClaim claim_in(const std::filesystem::path& file) {
        const FileProvenance provenance = read_provenance(file);
        EXPECT_TRUE(provenance.is_unchanged()) << file;
        return edits_of(provenance.metadata.claim).at(0);
    }
};

TEST_F(ProvenanceTest, ADateIsThatOfTheBeginInAllFiles) {
    set_time("1700000000");
    const EditRequest whole = request("whole", 2);
    edit_model(whole);
    EditRequest parts = request("parts", 2);
    parts.stop_after = 1;
    EXPECT_THROW(edit_model(parts), Interrupted);
    set_time("1800000000");
    parts.stop_after = 0;
    parts.resume = true;
    const nlohmann::json record = edit_model(parts);
    EXPECT_EQ(read_bytes(whole.output / "model.glb"), read_bytes(parts.output / "model.glb"));
    const EditClaim claim = claim_in(parts.output / "model.glb");
    EXPECT_EQ(claim.date, "2023-11-14T22:13:20Z");
    EXPECT_EQ(claim.from, "a red cube");
    EXPECT_EQ(claim.to, "a blue cube");
    EXPECT_EQ(claim.prior, "pipeline_sd");
    EXPECT_EQ(claim.prior_hash.size(), 16u);
    EXPECT_EQ(claim.input_sha256.size(), 64u);
    EXPECT_EQ(record["claim"].get<EditClaim>(), claim);
    for (const auto& texture : std::filesystem::directory_iterator(parts.output / "textures"))
        EXPECT_EQ(claim_in(texture.path()), claim);

    LayeredModelRequest layered;
    layered.model = parts.model;
    layered.output = folder_ / "layered.glb";
    layered.layers = {parse_layer_use(parts.output.string())};
    write_layered_model(layered);
    EXPECT_EQ(read_bytes(layered.output), read_bytes(whole.output / "model.glb"));
    layered.layers = {parse_layer_use(parts.output.string() + ":0.5:roughness,base_color")};
    write_layered_model(layered);
    EXPECT_EQ(claim_in(layered.output).strength, "0.5:base_color,roughness");
    EXPECT_EQ(claim_in(layered.output).date, claim.date);
}

TEST_F(ProvenanceTest, NothingButThePacketsDependsOnIt) {
    const EditRequest silent = request("silent", 1, {{"provenance", "off"}});
    edit_model(silent);
    const EditRequest plain = request("plain", 1);
    edit_model(plain);
    EXPECT_FALSE(read_provenance(silent.output / "model.glb").has_claim());
    for (const auto& texture : std::filesystem::directory_iterator(silent.output / "textures"))
        EXPECT_FALSE(read_provenance(texture.path()).has_claim());
    EXPECT_EQ(base_color_of(silent.output / "model.glb").pixels,
              base_color_of(plain.output / "model.glb").pixels);
    LayeredModelRequest layered;
    layered.model = silent.model;
    layered.output = folder_ / "layered.glb";
    layered.layers = {parse_layer_use(silent.output.string())};
    write_layered_model(layered);
    EXPECT_EQ(read_bytes(layered.output), read_bytes(silent.output / "model.glb"));
}

}  // namespace
}  // namespace item3d
