// Tests of the whole edit on a small model with a prior of random weights: outputs, resuming to the
// same bytes, and untouched parts.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/render/cuda/module.h"
#include "tests/support/edit.h"

#include <ATen/Context.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using testing::EditTest;

/// Must be queried first: LibTorch looks for devices only once.
const bool has_device = cuda::cuda_available();

TEST_F(EditTest, LeavesEveryPromisedFileAndAFullSummary) {
    const EditRequest edit = request("out", 3);
    const nlohmann::json summary = edit_model(edit);
    for (const char* name :
         {"model.glb", "before.png", "after.png", "turntable.webp", "report.html", "edit.json",
          "checkpoint.safetensors", "layer.safetensors", "textures/paint_base_color.png"}) {
        EXPECT_TRUE(fs::is_regular_file(edit.output / name)) << name;
    }
    for (const char* key :
         {"version", "command", "from", "to", "prior", "guidance", "seed", "device", "precision",
          "threads", "iterations", "seconds", "seconds_per_iteration", "peak_memory_bytes"}) {
        EXPECT_TRUE(summary.contains(key)) << key;
    }
    for (const char* stage : {"load", "fit", "optimize", "bake", "report", "total"}) {
        EXPECT_TRUE(summary["seconds"].contains(stage)) << stage;
    }
    EXPECT_EQ(nlohmann::json::parse(read_text(edit.output / "edit.json")), summary);
}

TEST_F(EditTest, TexturesAreWrittenInTheFormatThatIsAskedFor) {
    const EditRequest edit = request("out", 1, {{"texture_format", "jpeg"}});
    edit_model(edit);
    EXPECT_TRUE(fs::is_regular_file(edit.output / "textures" / "paint_base_color.jpg"));
    EXPECT_FALSE(fs::exists(edit.output / "textures" / "paint_base_color.png"));
    const Model model = load_model(edit.output / "model.glb");
    const int texture = model.materials.at(0).base_color_texture;
    EXPECT_EQ(model.textures.at(static_cast<std::size_t>(texture)).coding.encoding,
              ImageEncoding::jpeg);
    EXPECT_THROW(request("out", 1, {{"texture_format", "dds"}}), InputError);
}

TEST_F(EditTest, ZeroIterationsReturnTheTexture) {
    const EditRequest edit = request("out", 0);
    edit_model(edit);
    const Image before = base_color_of(edit.model);
    const Image after = base_color_of(edit.output / "model.glb");
    ASSERT_EQ(before.width, after.width);
    double error = 0;
    for (std::size_t i = 0; i < before.pixels.size(); ++i) {
        error = std::max<double>(error, std::abs(before.pixels[i] - after.pixels[i]));
    }
    EXPECT_LT(error, 0.5 / 255);
}

TEST_F(EditTest, IterationsChangeTheTextureAndDependOnTheSeed) {
    EditRequest edit = request("a", 8);
    edit_model(edit);
    const Bytes first = read_bytes(edit.output / "model.glb");
    edit.output = folder_ / "b";
    edit_model(edit);
    EXPECT_EQ(first, read_bytes(edit.output / "model.glb"));
    edit.output = folder_ / "c";
    change(edit, {{"seed", 1}});
    edit_model(edit);
    EXPECT_NE(first, read_bytes(edit.output / "model.glb"));
    EXPECT_NE(base_color_of(edit.model).pixels, base_color_of(edit.output / "model.glb").pixels);
}

TEST_F(EditTest, ResumesToTheSameBytesAfterTwoInterrupts) {
    EditRequest edit = request("whole", 6,
                               {{"light_augment", "rotate"},
                                {"evenness", 100},
                                {"detail", "always"},
                                {"detail_views", 2}});
    edit_model(edit);
    const Bytes whole = read_bytes(edit.output / "model.glb");

    edit.output = folder_ / "parts";
    for (const int stop : {3, 7}) {  // 7 is between views of the detail stage
        edit.stop_after = stop;
        EXPECT_THROW(edit_model(edit), Interrupted);
        EXPECT_FALSE(fs::exists(edit.output / "model.glb"));
        edit.resume = true;
    }
    edit.stop_after = 0;
    edit_model(edit);
    EXPECT_EQ(whole, read_bytes(edit.output / "model.glb"));
}

TEST_F(EditTest, DetailChangesTheBaseColorAndLittleElse) {
    const EditRequest edit =
        request("out", 1,
                {{"learning_rate", 1e-9},  // so all changes come from the detail stage
                 {"metallic", "always"},
                 {"detail", "always"},
                 {"detail_views", 1}});
    const nlohmann::json summary = edit_model(edit);
    EXPECT_TRUE(summary["seconds"].contains("detail"));
    const auto& before = summary["scores"]["before"];
    const auto& after = summary["scores"]["after"];
    EXPECT_NEAR(after["metallic"], before["metallic"], 0.02);
    EXPECT_NEAR(after["roughness"], before["roughness"], 0.02);
    const Image was = base_color_of(edit.model);
    const Image now = base_color_of(edit.output / "model.glb");
    double changed = 0;
    for (std::size_t i = 0; i < was.pixels.size(); ++i)
        changed += std::abs(was.pixels[i] - now.pixels[i]);
    EXPECT_GT(changed / static_cast<double>(was.pixels.size()), 0.01);
}

TEST_F(EditTest, AThingWithoutAWordIsEditedAsAnObject) {
    EditRequest edit = request("cube", 2, {{"detail", "always"}, {"detail_views", 1}});
    const fs::path prior = folder_ / "prior";
    fs::copy(edit.prior, prior, fs::copy_options::recursive);
    write_atomically(prior / "prior.json",
                     std::string(R"({"words": ["a", "red", "blue", "object"]})"));
    edit.prior = prior;
    const nlohmann::json summary = edit_model(edit);
    EXPECT_EQ(summary["to"], "a blue cube");
    EXPECT_EQ(summary["read_as"]["to"], "a blue object");
    EditRequest named = edit;
    named.output = folder_ / "object";
    change(named, {{"from", "a red object"}, {"to", "a blue object"}});
    edit_model(named);
    EXPECT_EQ(base_color_of(edit.output / "model.glb").pixels,
              base_color_of(named.output / "model.glb").pixels);
}

TEST_F(EditTest, ACheckpointOfOtherSettingsIsRefused) {
    EditRequest edit = request("out", 2);
    edit_model(edit);
    edit.resume = true;
    change(edit, {{"to", "a green cube"}});
    EXPECT_THROW(edit_model(edit), InputError);
}

TEST_F(EditTest, ACheckpointOfOtherWeightsIsRefused) {
    EditRequest edit = request("out", 2);
    const fs::path prior = folder_ / "prior";
    fs::copy(edit.prior, prior, fs::copy_options::recursive);
    edit.prior = prior;
    edit.stop_after = 1;
    EXPECT_THROW(edit_model(edit), Interrupted);

    edit.resume = true;
    edit.stop_after = 0;
    const fs::path file = prior / "unet" / "diffusion_pytorch_model.safetensors";
    const Bytes good = read_bytes(file);
    Bytes bad = good;
    bad.back() ^= 1;
    write_atomically(file, bad);
    EXPECT_THROW(edit_model(edit), InputError);
    write_atomically(file, good);
    EXPECT_NO_THROW(edit_model(edit));
}

TEST_F(EditTest, WhatIsAddedToThePriorChangesTheEditAndIsKeptInMind) {
    const std::string lora = (folder_ / "style.safetensors").string();
    const std::string layer = "lora_unet_mid_block_attentions_0_proj_in";
    save_safetensors(lora, {{layer + ".lora_down.weight", at::ones({1, 16})},
                            {layer + ".lora_up.weight", at::ones({16, 1})}});
    const fs::path models = fs::path(ITEM3D_TEST_DATA) / "models";
    EditRequest edit = request("out", 2, {{"detail", "always"}, {"detail_views", 1}});
    edit_model(edit);
    const Bytes plain = read_bytes(edit.output / "model.glb");

    const std::string inversion = models / "textual_inversion/learned_embeds.safetensors";
    change(edit, {{"lora", {lora + ":0.5"}},
                  {"embedding", {inversion}},
                  {"controlnet", (models / "controlnet_depth").string()},
                  {"vae", (models / "vae_tiny").string()},
                  {"to", "a <cat-toy> cube"},
                  {"negative_prompt", "grey"}});
    const nlohmann::json summary = edit_model(edit);
    EXPECT_NE(plain, read_bytes(edit.output / "model.glb"));
    EXPECT_EQ(summary["settings"]["lora"], nlohmann::json::array({lora + ":0.5"}));
    EXPECT_EQ(summary["settings"]["controlnet_scale"], 1);

    edit.resume = true;
    edit_model(edit);
    EditRequest other = edit;
    change(other, {{"lora", {lora}}});
    EXPECT_THROW(edit_model(other), InputError);
    other = edit;
    change(other, {{"controlnet_scale", 0.5f}});
    EXPECT_THROW(edit_model(other), InputError);
    other = edit;
    change(other, {{"vae", ""}});
    EXPECT_THROW(edit_model(other), InputError);
}

TEST_F(EditTest, ABrokenCheckpointIsRefused) {
    EditRequest edit = request("out", 2);
    fs::create_directories(edit.output);
    write_atomically(edit.output / "checkpoint.safetensors", std::string_view("not one"));
    edit.resume = true;
    EXPECT_THROW(edit_model(edit), InputError);
}

TEST_F(EditTest, KeptBaseColorStaysAsItIs) {
    const EditRequest edit = request("out", 6, {{"keep", {"base_color", "occlusion", "normal"}}});
    edit_model(edit);
    EXPECT_EQ(base_color_of(edit.model).pixels, base_color_of(edit.output / "model.glb").pixels);
}

TEST_F(EditTest, UnknownMaterialAndUnwritableOutputAreRefused) {
    EditRequest edit = request("out", 1, {{"material", {"glass"}}});
    EXPECT_THROW(edit_model(edit), InputError);
    edit = request("out", 1);
    edit.output = folder_ / "cube.glb" / "out";
    EXPECT_THROW(edit_model(edit), InputError);
}

TEST_F(EditTest, MetallicBeginsHalfWayWhereOnlyOnePromptNamesAMetal) {
    const auto metallic_after = [&](const std::string& name, const std::string& to) {
        const EditRequest edit = request(name, 1, {{"to", to}, {"learning_rate", 1e-6}});
        return edit_model(edit)["scores"]["after"]["metallic"].get<double>();
    };
    EXPECT_NEAR(metallic_after("metal", "a golden cube"), 0.5, 0.05);
    EXPECT_NEAR(metallic_after("paint", "a blue cube"), 0.0, 0.01);
}

TEST_F(EditTest, ADeviceEditsAsTheCpuDoes) {
    if (!has_device)
        GTEST_SKIP() << "no CUDA device, or no libtorch_cuda.so: nothing to compare the CPU with";
    at::globalContext().setAllowTF32CuDNN(false);
    std::vector<Image> colors;
    for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
        EditRequest edit = request(device.is_cuda() ? "cuda" : "cpu", 2,
                                   {{"detail", "always"}, {"detail_views", 1}});
        edit.device = device;
        // The edit is stopped and resumed, so that its state goes from the device to a checkpoint
        // and back.
        edit.stop_after = 1;
        EXPECT_THROW(edit_model(edit), Interrupted);
        edit.stop_after = 0;
        edit.resume = true;
        EXPECT_EQ(edit_model(edit)["device"], device.is_cuda() ? "cuda" : "cpu");
        colors.push_back(base_color_of(edit.output / "model.glb"));
    }
    EXPECT_LT(mean_difference(colors[0], colors[1]), 0.01);
}

}  // namespace
}  // namespace item3d
