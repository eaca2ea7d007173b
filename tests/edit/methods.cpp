// Tests of edits by methods other than this project's own: files, resuming, regions, and limits.
#include "item3d/baselines/methods.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/tensors/safetensors.h"
#include "tests/support/edit.h"

namespace item3d::testing {
namespace {

class MethodTest : public EditTest {
  protected:
    EditRequest by(const std::string& method, const std::string& output, int iterations,
                   const nlohmann::json& more = nlohmann::json::object()) const {
        EditRequest edit = request(output, iterations, {{"method", method}});
        change(edit, method_settings(method));
        change(edit, {{"method", method}, {"steps", 2}, {"views", 3}, {"fit_steps", 1}});
        change(edit, more);
        return edit;
    }
    static const fs::path& models() {
        static const fs::path folder = fs::path(ITEM3D_TEST_DATA) / "models";
        return folder;
    }
};

TEST_F(MethodTest, APainterLeavesWhatAnEditLeavesAndItsViews) {
    const EditRequest edit = by("texture", "out", 0);
    const nlohmann::json summary = edit_model(edit);
    for (const char* name : {"model.glb", "before.png", "after.png", "turntable.webp",
                             "report.html", "edit.json", "checkpoint.safetensors", "views/00.png",
                             "views/02.png", "textures/paint_base_color.png"})
        EXPECT_TRUE(fs::is_regular_file(edit.output / name)) << name;
    EXPECT_FALSE(fs::exists(edit.output / "views/03.png"));
    EXPECT_EQ(summary["method"], "texture");
    EXPECT_EQ(summary["views"].size(), 3u);
    EXPECT_EQ(summary["unet_rows"], 3 * (2 + 1) * 2);
    EXPECT_TRUE(summary["seconds"].contains("paint"));
    const Image before = base_color_of(edit.model),
                after = base_color_of(edit.output / "model.glb");
    EXPECT_EQ(before.width, after.width);
    EXPECT_NE(before.pixels, after.pixels);
    // Only the base colour of the material changes.
    EXPECT_EQ(summary["scores"]["before"]["roughness"], summary["scores"]["after"]["roughness"]);
    EXPECT_EQ(summary["scores"]["before"]["metallic"], summary["scores"]["after"]["metallic"]);
}

TEST_F(MethodTest, APainterResumesBetweenItsViewsToTheSameBytes) {
    EditRequest edit = by("texture", "whole", 0);
    const nlohmann::json whole = edit_model(edit);
    const Bytes model = read_bytes(edit.output / "model.glb");
    edit.output = folder_ / "parts";
    edit.stop_after = 2;
    EXPECT_THROW(edit_model(edit), Interrupted);
    EXPECT_FALSE(fs::exists(edit.output / "model.glb"));
    edit.resume = true;
    edit.stop_after = 0;
    const nlohmann::json parts = edit_model(edit);
    EXPECT_EQ(model, read_bytes(edit.output / "model.glb"));
    EXPECT_EQ(parts["unet_rows"], whole["unet_rows"]);
    change(edit, {{"views", 2}});
    EXPECT_THROW(edit_model(edit), InputError);
}

TEST_F(MethodTest, PredictionsThatAreNotFiniteAreAnErrorAndLeaveNoModel) {
    const fs::path damaged = folder_ / "damaged";
    fs::copy(models() / "pipeline_sd", damaged, fs::copy_options::recursive);
    for (const char* network : {"unet", "vae"}) {
        const fs::path file = fs::path(network) / "diffusion_pytorch_model.safetensors";
        NamedTensors tensors;
        for (const auto& [name, tensor] :
             SafeTensors::open(models() / "pipeline_sd" / file).tensors())
            tensors.emplace_back(name, tensor * std::numeric_limits<float>::quiet_NaN());
        save_safetensors(damaged / file, tensors);
        for (const std::string method : {"item3d", "texture"}) {
            EditRequest edit = by(method, method + network, 4);
            edit.prior = damaged;
            try {
                edit_model(edit);
                ADD_FAILURE() << "no error for a damaged " << network << " with " << method;
            } catch (const InputError& error) {
                EXPECT_NE(std::string(error.what()).find("not finite"), std::string::npos)
                    << error.what();
            }
            EXPECT_FALSE(fs::exists(edit.output / "model.glb"));
        }
        fs::copy_file(models() / "pipeline_sd" / file, damaged / file,
                      fs::copy_options::overwrite_existing);
    }
}

TEST_F(MethodTest, TexelsOutsideOfARegionStayToTheBit) {
    const EditRequest edit = by("controlnet-2d", "out", 0, {{"region", {"box=-1,-1,-1,1,0,1"}}});
    const nlohmann::json summary = edit_model(edit);
    EXPECT_GT(summary["region"]["outside"]["texels"], 100);
    EXPECT_EQ(summary["region"]["outside"]["changed"], 0);
    EXPECT_NE(base_color_of(edit.model).pixels, base_color_of(edit.output / "model.glb").pixels);
}

TEST_F(MethodTest, In2nEditsByAPriorThatFollowsInstructionsAlone) {
    EditRequest edit = by("in2n", "out", 11, {{"iterations", 11}});
    const auto complaint = [&] {
        try {
            edit_model(edit);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(complaint().find("is not an InstructPix2Pix"), std::string::npos);
    edit.instruct = models() / "pipeline_ip2p";
    const nlohmann::json whole = edit_model(edit);
    EXPECT_EQ(whole["unet_rows"], 2 * 2 * 3);  // 2 images, 2 steps, 3 rows each
    EXPECT_NE(base_color_of(edit.model).pixels, base_color_of(edit.output / "model.glb").pixels);
}

TEST_F(MethodTest, ClipNeedsAClipAndAsksNoUnet) {
    EditRequest edit = by("clip", "out", 2, {{"clip_loss", "directional"}});
    EXPECT_THROW(edit_model(edit), InputError);
    const char* assets = std::getenv("ITEM3D_ASSETS");
    edit.teacher = fs::path(assets ? assets : "assets") / "prior" / "clip";
    EXPECT_EQ(edit_model(edit)["unet_rows"], 0);
    EXPECT_NE(base_color_of(edit.model).pixels, base_color_of(edit.output / "model.glb").pixels);
}

TEST_F(MethodTest, AnInpaintingNetworkTakesPartWhereItIsGiven) {
    EditRequest edit = by("texture", "plain", 0, {{"steps", 10}, {"views", 2}});
    edit_model(edit);
    const Image plain = base_color_of(edit.output / "model.glb");
    edit.output = folder_ / "inpainted";
    edit.inpainting = models() / "pipeline_inpaint" / "inpaint";
    edit_model(edit);
    EXPECT_NE(plain.pixels, base_color_of(edit.output / "model.glb").pixels);
    edit.inpainting = models() / "pipeline_sd";
    edit.output = folder_ / "wrong";
    EXPECT_THROW(edit_model(edit), InputError);
}

TEST_F(MethodTest, AMethodThatThereIsNotIsRefused) {
    EXPECT_THROW(resolve_plan(models() / "pipeline_sd", {{"method", "magic"}}), InputError);
    EXPECT_EQ(resolve_plan(models() / "pipeline_sd", {{"method", "sds"}}).guidance, "sds");
    EXPECT_EQ(resolve_plan(models() / "pipeline_sd", {{"method", "texture"}}).total_iterations, 10);
}

}  // namespace
}  // namespace item3d::testing
