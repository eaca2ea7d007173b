// The whole path on a small model with a prior of random weights: what it leaves, that it resumes
// to the same bytes, and that it keeps what it must not touch.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/edit/material_source.h"
#include "item3d/edit/metals.h"
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

/// Asked before any test has LibTorch look for a device, which it does once.
const bool has_device = cuda::cuda_available();

TEST_F(EditTest, leaves_every_promised_file_and_a_full_summary) {
    const EditRequest edit = request("out", 3);
    const nlohmann::json summary = edit_model(edit);
    for (const char* name :
         {"model.glb", "before.png", "after.png", "turntable.webp", "report.html", "edit.json",
          "checkpoint.safetensors", "textures/paint_base_color.png"}) {
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

TEST_F(EditTest, zero_iterations_return_the_texture) {
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

TEST_F(EditTest, iterations_change_the_texture_and_depend_on_the_seed) {
    EditRequest edit = request("a", 8);
    edit_model(edit);
    const Bytes first = read_bytes(edit.output / "model.glb");
    edit.output = folder_ / "b";
    edit_model(edit);
    EXPECT_EQ(first, read_bytes(edit.output / "model.glb"));
    edit.output = folder_ / "c";
    edit.settings.seed = 1;
    edit_model(edit);
    EXPECT_NE(first, read_bytes(edit.output / "model.glb"));
    EXPECT_NE(base_color_of(edit.model).pixels, base_color_of(edit.output / "model.glb").pixels);
}

TEST_F(EditTest, resumes_to_the_same_bytes_after_two_interrupts) {
    EditRequest edit = request("whole", 6);
    edit.settings.light_augment = "all";
    edit.settings.evenness = 100;
    edit.settings.detail = "always";
    edit.settings.detail_views = 2;
    edit_model(edit);
    const Bytes whole = read_bytes(edit.output / "model.glb");

    edit.output = folder_ / "parts";
    for (const int stop : {3, 7}) {  // the second is between the views of the detail stage
        edit.stop_after = stop;
        EXPECT_THROW(edit_model(edit), Interrupted);
        EXPECT_FALSE(fs::exists(edit.output / "model.glb"));
        edit.resume = true;
    }
    edit.stop_after = 0;
    edit_model(edit);
    EXPECT_EQ(whole, read_bytes(edit.output / "model.glb"));
}

TEST_F(EditTest, detail_changes_the_base_color_and_little_else) {
    EditRequest edit = request("out", 1);
    edit.settings.learning_rate = 1e-9f;  // what changes is the detail stage's doing
    edit.settings.metallic = "always";
    edit.settings.detail = "always";
    edit.settings.detail_views = 2;
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

TEST_F(EditTest, a_thing_without_a_word_is_edited_as_an_object) {
    EditRequest edit = request("cube", 2);
    const fs::path prior = folder_ / "prior";
    fs::copy(edit.prior, prior, fs::copy_options::recursive);
    write_atomically(prior / "prior.json",
                     std::string(R"({"words": ["a", "red", "blue", "object"]})"));
    edit.prior = prior;
    edit.settings.detail = "always";
    edit.settings.detail_views = 2;
    const nlohmann::json summary = edit_model(edit);
    EXPECT_EQ(summary["to"], "a blue cube");
    EXPECT_EQ(summary["read_as"]["to"], "a blue object");
    EditRequest named = edit;
    named.output = folder_ / "object";
    named.settings.from = "a red object";
    named.settings.to = "a blue object";
    edit_model(named);
    EXPECT_EQ(base_color_of(edit.output / "model.glb").pixels,
              base_color_of(named.output / "model.glb").pixels);
}

TEST_F(EditTest, a_checkpoint_of_other_settings_is_refused) {
    EditRequest edit = request("out", 2);
    edit_model(edit);
    edit.resume = true;
    edit.settings.to = "a green cube";
    EXPECT_THROW(edit_model(edit), InputError);
}

TEST_F(EditTest, a_checkpoint_of_other_weights_is_refused) {
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

TEST_F(EditTest, what_is_added_to_the_prior_changes_the_edit_and_is_kept_in_mind) {
    const std::string lora = (folder_ / "style.safetensors").string();
    const std::string layer = "lora_unet_mid_block_attentions_0_proj_in";
    save_safetensors(lora, {{layer + ".lora_down.weight", at::ones({1, 16})},
                            {layer + ".lora_up.weight", at::ones({16, 1})}});
    const fs::path models = fs::path(ITEM3D_TEST_DATA) / "models";
    EditRequest edit = request("out", 2);
    edit.settings.detail = "always";
    edit.settings.detail_views = 1;
    edit_model(edit);
    const Bytes plain = read_bytes(edit.output / "model.glb");

    edit.settings.lora = {lora + ":0.5"};
    edit.settings.embedding = {(models / "textual_inversion/learned_embeds.safetensors").string()};
    edit.settings.controlnet = (models / "controlnet_depth").string();
    edit.settings.vae = (models / "vae_tiny").string();
    edit.settings.to = "a <cat-toy> cube";
    edit.settings.negative_prompt = "grey";
    const nlohmann::json summary = edit_model(edit);
    EXPECT_NE(plain, read_bytes(edit.output / "model.glb"));
    EXPECT_EQ(summary["settings"]["lora"], nlohmann::json::array({lora + ":0.5"}));
    EXPECT_EQ(summary["settings"]["controlnet_scale"], 1);

    edit.resume = true;
    edit_model(edit);
    EditRequest other = edit;
    other.settings.lora = {lora};
    EXPECT_THROW(edit_model(other), InputError);
    other = edit;
    other.settings.controlnet_scale = 0.5f;
    EXPECT_THROW(edit_model(other), InputError);
    other = edit;
    other.settings.vae.clear();
    EXPECT_THROW(edit_model(other), InputError);
}

TEST_F(EditTest, a_broken_checkpoint_is_refused) {
    EditRequest edit = request("out", 2);
    fs::create_directories(edit.output);
    write_atomically(edit.output / "checkpoint.safetensors", std::string_view("not one"));
    edit.resume = true;
    EXPECT_THROW(edit_model(edit), InputError);
}

TEST_F(EditTest, kept_base_color_stays_as_it_is) {
    EditRequest edit = request("out", 6);
    edit.settings.keep = {"base_color", "occlusion", "normal"};
    edit_model(edit);
    EXPECT_EQ(base_color_of(edit.model).pixels, base_color_of(edit.output / "model.glb").pixels);
}

TEST_F(EditTest, unknown_material_and_unwritable_output_are_refused) {
    EditRequest edit = request("out", 1);
    edit.settings.material = {"glass"};
    EXPECT_THROW(edit_model(edit), InputError);
    edit = request("out", 1);
    edit.output = folder_ / "cube.glb" / "out";
    EXPECT_THROW(edit_model(edit), InputError);
}

TEST_F(EditTest, metallic_begins_half_way_where_only_one_prompt_names_a_metal) {
    const auto metallic_after = [&](const std::string& name, const std::string& to) {
        EditRequest edit = request(name, 1);
        edit.settings.to = to;
        edit.settings.learning_rate = 1e-6f;
        return edit_model(edit)["scores"]["after"]["metallic"].get<double>();
    };
    EXPECT_NEAR(metallic_after("metal", "a golden cube"), 0.5, 0.05);
    EXPECT_NEAR(metallic_after("paint", "a blue cube"), 0.0, 0.01);
}

TEST_F(EditTest, metallic_is_left_alone_where_no_metal_is_named) {
    const auto is_edited = [&](const std::string& to, const std::string& metallic) {
        EditSettings settings = request("out", 1).settings;
        settings.to = to;
        settings.metallic = metallic;
        return edited_channels(settings).metallic;
    };
    EXPECT_FALSE(is_edited("a wooden cube", "auto"));
    EXPECT_TRUE(is_edited("a wooden cube", "always"));
    EXPECT_TRUE(is_edited("a copper cube", "auto"));
}

TEST_F(EditTest, a_device_edits_as_the_cpu_does) {
    if (!has_device)
        GTEST_SKIP() << "no CUDA device, or no libtorch_cuda.so: nothing to compare the CPU with";
    at::globalContext().setAllowTF32CuDNN(false);
    std::vector<Image> colors;
    for (const at::Device device : {at::Device(at::kCPU), at::Device(at::kCUDA, 0)}) {
        EditRequest edit = request(device.is_cuda() ? "cuda" : "cpu", 2);
        edit.device = device;
        edit.settings.detail = "always";
        edit.settings.detail_views = 1;
        // Stopped and resumed, so that the checkpoint goes to the device and back.
        edit.stop_after = 1;
        EXPECT_THROW(edit_model(edit), Interrupted);
        edit.stop_after = 0;
        edit.resume = true;
        EXPECT_EQ(edit_model(edit)["device"], device.is_cuda() ? "cuda" : "cpu");
        colors.push_back(base_color_of(edit.output / "model.glb"));
    }
    ASSERT_EQ(colors[0].pixels.size(), colors[1].pixels.size());
    double apart = 0;
    for (std::size_t i = 0; i < colors[0].pixels.size(); ++i)
        apart += std::abs(colors[0].pixels[i] - colors[1].pixels[i]);
    EXPECT_LT(apart / static_cast<double>(colors[0].pixels.size()), 0.01);
}

TEST(Metals, are_found_as_whole_words) {
    EXPECT_TRUE(names_metal("a Golden mug"));
    EXPECT_TRUE(names_metal("a mug of gold"));
    EXPECT_TRUE(names_metal("gold"));
    EXPECT_FALSE(names_metal("a marigold"));
    EXPECT_FALSE(names_metal("a goldfish in a tinderbox"));
    EXPECT_FALSE(names_metal(""));
    EXPECT_TRUE(crosses_metallic("a steel door", "a wooden door"));
    EXPECT_FALSE(crosses_metallic("a silver ring", "a golden ring"));
}

TEST(EditSettings, detail_is_wanted_where_the_target_alone_names_such_a_material) {
    EditSettings settings;
    settings.from = "a red mug";
    settings.to = "a Marble mug";
    EXPECT_FALSE(wants_detail(settings));
    settings.detail_words = {"wooden", "marble"};
    EXPECT_TRUE(wants_detail(settings));
    settings.from = "a marble mug, red";
    EXPECT_FALSE(wants_detail(settings));
    settings.detail = "always";
    EXPECT_TRUE(wants_detail(settings));
    settings.keep = {"base_color"};
    EXPECT_FALSE(wants_detail(settings));
    settings.keep = {};
    settings.iterations = 0;
    EXPECT_FALSE(wants_detail(settings));
}

TEST(EditSettings, fewer_iterations_come_before_the_detail_stage_unless_they_are_given) {
    const fs::path folder =
        fs::temp_directory_path() / ("item3d-before-detail-" + std::to_string(::getpid()));
    fs::create_directories(folder);
    write_atomically(folder / "prior.json", std::string_view(R"({"defaults": {"iterations": 150,
        "iterations_before_detail": 60, "detail_words": ["mossy"]}})"));
    const nlohmann::json painted = {{"from", "a cow"}, {"to", "a mossy cow"}};
    const auto with = [&](const nlohmann::json& more) {
        nlohmann::json overrides = painted;
        overrides.update(more);
        return resolve_settings(folder, overrides).iterations;
    };
    EXPECT_EQ(with(nlohmann::json::object()), 60);
    EXPECT_EQ(with({{"to", "a red cow"}}), 150);
    EXPECT_EQ(with({{"detail", "off"}}), 150);
    EXPECT_EQ(with({{"optimize", "both"}}), 150);
    EXPECT_EQ(with({{"iterations", 200}}), 200);
    EXPECT_THROW(with({{"iterations_before_detail", -1}}), InputError);
    fs::remove_all(folder);
}

TEST(EditSettings, prior_defaults_and_overrides_are_merged_and_checked) {
    const fs::path folder =
        fs::temp_directory_path() / ("item3d-prior-" + std::to_string(::getpid()));
    fs::create_directories(folder);
    write_atomically(folder / "prior.json",
                     std::string_view(R"({"defaults": {"iterations": 150, "resolution": 64}})"));
    const EditSettings settings = resolve_settings(folder, {{"iterations", 20}});
    EXPECT_EQ(settings.iterations, 20);
    EXPECT_EQ(settings.resolution, 64);
    EXPECT_EQ(settings.timestep_schedule, "uniform");
    // A method that is asked for brings what it was published with; what is said goes before.
    const EditSettings inverted = resolve_settings(folder, {{"guidance", "sdi"}, {"cfg", 5}});
    EXPECT_EQ(inverted.timestep_schedule, "anneal");
    EXPECT_EQ(inverted.timesteps, (std::vector<float>{0.25f, 0.98f}));
    EXPECT_EQ(inverted.cfg, 5);
    EXPECT_EQ(inverted.resolution, 64);
    EXPECT_THROW(resolve_settings(folder, {{"timesteps", {0.9, 0.1}}}), InputError);
    EXPECT_THROW(resolve_settings(folder, {{"keep", {"colour"}}}), InputError);
    EXPECT_THROW(resolve_settings(folder, {{"batch", 0}}), InputError);
    EXPECT_THROW(resolve_settings(folder, {{"evenness", -1}}), InputError);
    EXPECT_THROW(resolve_settings(folder, {{"evenness", INFINITY}}), InputError);
    EXPECT_THROW(resolve_settings(folder, {{"detail", "some"}}), InputError);
    write_atomically(folder / "prior.json", std::string_view("[1"));
    EXPECT_THROW(resolve_settings(folder, {}), InputError);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace item3d
