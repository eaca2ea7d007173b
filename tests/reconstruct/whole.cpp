// Tests of whole reconstructions from small images that our own renderer draws.
#include "item3d/core/error.h"
#include "item3d/io/load.h"
#include "item3d/io/read_provenance.h"
#include "item3d/lighting/environment.h"
#include "item3d/reconstruct/outputs/scores.h"
#include "item3d/reconstruct/outputs/stage_preview.h"
#include "item3d/reconstruct/reconstruct.h"
#include "item3d/reconstruct/surface/plain_model.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/render.h"
#include "item3d/render/scatter.h"
#include "item3d/render/srgb.h"
#include "item3d/render/textured_materials.h"
#include "item3d/scene/sphere.h"
#include "tests/support/reconstruct.h"

#include <cmath>
#include <cstdlib>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Returns a sphere with broad stripes of different colours.
Model striped_sphere() {
    Model model = make_unit_sphere(24, 32);
    for (Vec3& position : model.primitives.front().positions)
        position *= 0.9f;
    Material& material = model.materials.back();
    material.metallic_factor = 0;
    material.roughness_factor = 0.6f;
    Texture stripes;
    stripes.image = Image(64, 32, 3);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c)
                stripes.image.at(x, y, c) = (x / 8) % 2 == 0 ? 0.8f : (c == 0 ? 0.7f : 0.2f);
    model.textures.push_back(stripes);
    material.base_color_texture = 0;
    return model;
}

/// Writes sphere.glb and a NeRF-synthetic dataset of the sphere in the light of noon. Returns the
/// folder.
fs::path sphere_dataset(const std::string& name, int train, int test, int size) {
    const at::NoGradGuard no_gradient;
    const fs::path folder = testing::fresh_folder(name);
    const Model model = striped_sphere();
    save_model(folder / "sphere.glb", model);
    const Geometry geometry = Geometry::from_model(model);
    const TexturedMaterials materials(model);
    const EnvironmentLight light = prefilter(make_light_preset("noon", 64), 64);
    RenderOptions options;
    options.width = options.height = size;
    for (const auto& [split, count] : {std::pair{"train", train}, std::pair{"test", test}}) {
        fs::create_directories(folder / split);
        nlohmann::json document{{"camera_angle_x", 0.7}, {"frames", nlohmann::json::array()}};
        for (int i = 0; i < count; ++i) {
            Camera camera =
                orbit_camera(Vec3(0), 4, 2.4f * static_cast<float>(i) + (count == test ? 1.1f : 0),
                             0.9f * std::sin(1.7f * static_cast<float>(i)), 0.7f);
            const std::string file = std::string(split) + "/r_" + std::to_string(i);
            const Image image = to_image(render(geometry, materials, light, {camera}, options)[0]);
            Image straight = image;
            for (int p = 0; p < size * size; ++p) {
                float* pixel = &straight.pixels[static_cast<std::size_t>(4 * p)];
                for (int c = 0; c < 3; ++c)
                    pixel[c] = pixel[3] > 0
                                   ? linear_to_srgb(std::clamp(pixel[c] / pixel[3], 0.0f, 1.0f))
                                   : 0.0f;
            }
            save_image(folder / (file + ".png"), straight);
            document["frames"].push_back(
                {{"file_path", "./" + file},
                 {"transform_matrix",
                  testing::rows_of(testing::y_up_to_z_up() * camera.camera_to_world)}});
        }
        write_atomically(folder / ("transforms_" + std::string(split) + ".json"),
                         std::string_view(document.dump()));
    }
    return folder;
}

TEST(Reconstruct, MaterialsAndLightOfAGivenMesh) {
    ReconstructRequest request;
    request.dataset = sphere_dataset("mesh", 12, 3, 48);
    request.output = testing::fresh_folder("mesh_out");
    request.mesh = request.dataset / "sphere.glb";
    request.reference = request.mesh;
    request.move_vertices = false;
    request.refine.iterations = 110;
    request.refine.traces = 2;
    request.refine.shadow_points = 4096;
    request.refine.light_every = 8;
    request.texture_size = 128;
    const nlohmann::json summary = reconstruct(request);
    EXPECT_GT(summary["scores"]["test"]["psnr"].get<double>(), 25);
    EXPECT_GT(summary["scores"]["test"]["mask_overlap"].get<double>(), 0.97);
    // The mesh was given, so it is nearly exact.
    EXPECT_LT(summary["scores"]["chamfer"].get<double>(), 0.01);

    const Model model = load_model(request.output / "model.glb");
    EXPECT_GE(model.materials[0].base_color_texture, 0);
    EXPECT_GE(model.materials[0].metallic_roughness_texture, 0);
    EXPECT_EQ(load_image(request.output / "light.hdr").width, 256);
    const std::string report = read_text(request.output / "report.html");
    EXPECT_NE(report.find("Held-out views"), std::string::npos);
    EXPECT_EQ(report.find("http://"), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(read_text(request.output / "reconstruct.json")), summary);
}

TEST(Reconstruct, ShapeFromImagesAlone) {
    ReconstructRequest request;
    request.dataset = sphere_dataset("shape", 16, 3, 48);
    request.output = testing::fresh_folder("shape_out");
    request.reference = request.dataset / "sphere.glb";
    request.shape.cells = {12, 24};
    request.shape.iterations = 80;
    request.shape.triangles = 2000;
    request.shape.light_every = 8;
    request.refine.iterations = 60;
    request.refine.traces = 2;
    request.refine.shadow_points = 4096;
    request.refine.light_every = 8;
    request.texture_size = 128;
    const nlohmann::json summary = reconstruct(request);
    EXPECT_GT(summary["scores"]["test"]["psnr"].get<double>(), 22);
    EXPECT_GT(summary["scores"]["test"]["mask_overlap"].get<double>(), 0.95);
    // A cell of the finest grid is 0.04 wide. After so few cells and steps, the error is about as
    // large.
    EXPECT_LT(summary["scores"]["chamfer"].get<double>(), 0.06);
    EXPECT_TRUE(summary["warnings"].empty());
}

/// Returns a request with a few steps in each of the two stages.
ReconstructRequest short_request(const fs::path& dataset, const std::string& output) {
    ReconstructRequest request;
    request.dataset = dataset;
    request.output = testing::fresh_folder(output);
    request.shape.cells = {8, 16};
    request.shape.iterations = 9;  // three on the coarse lattice
    request.shape.triangles = 600;
    request.shape.light_every = 4;  // the light takes most of a step's time
    request.refine.iterations = 6;
    request.refine.light_every = 4;
    request.refine.traces = 3;
    request.refine.shadow_points = 1024;
    request.texture_size = 64;
    request.command = "item3d reconstruct";
    return request;
}

TEST(Reconstruct, ResumesToTheSameBytesInEitherStageAndBetween) {
    const fs::path dataset = sphere_dataset("resume", 6, 2, 32);
    setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
    const ReconstructRequest whole = short_request(dataset, "resume_whole");
    const nlohmann::json summary = reconstruct(whole);

    ReconstructRequest parts = short_request(dataset, "resume_parts");
    // The stops are at the end of a lattice, within the next one, at the end of the shape, and
    // after tracing shadows.
    for (const int stop : {3, 5, 9, 12}) {
        parts.stop_after = stop;
        try {
            reconstruct(parts);
            FAIL() << "not interrupted at " << stop;
        } catch (const Interrupted& error) {
            EXPECT_STREQ(error.what(),
                         ("a checkpoint was saved at iteration " + std::to_string(stop) +
                          " of 15; continue with: item3d reconstruct --resume")
                             .c_str());
        }
        EXPECT_FALSE(fs::exists(parts.output / "model.glb"));
        parts.resume = true;
        // All dates must be that of the first start.
        setenv("SOURCE_DATE_EPOCH", "1800000000", 1);
    }
    parts.stop_after = 0;
    const nlohmann::json resumed = reconstruct(parts);
    for (const char* file : {"model.glb", "light.hdr"})
        EXPECT_EQ(read_bytes(whole.output / file), read_bytes(parts.output / file)) << file;
    EXPECT_EQ(summary["scores"], resumed["scores"]);

    ReconstructRequest other = parts;
    other.shape.cells = {10, 20};
    EXPECT_THROW(reconstruct(other), InputError);
    other = parts;
    other.dataset_options.longest_side = 24;
    EXPECT_THROW(reconstruct(other), InputError);
    other = parts;
    other.mesh = dataset / "sphere.glb";
    EXPECT_THROW(reconstruct(other), InputError);
    Bytes broken = read_bytes(parts.output / "checkpoint.safetensors");
    broken.resize(broken.size() / 2);
    write_atomically(parts.output / "checkpoint.safetensors",
                     std::span<const std::uint8_t>(broken));
    EXPECT_THROW(reconstruct(parts), InputError);
    EXPECT_EQ(read_bytes(whole.output / "model.glb"), read_bytes(parts.output / "model.glb"));
}

TEST(Reconstruct, ResumesWithAGivenMesh) {
    const fs::path dataset = sphere_dataset("resume_mesh", 6, 2, 32);
    setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
    ReconstructRequest whole = short_request(dataset, "resume_mesh_whole");
    whole.mesh = dataset / "sphere.glb";
    whole.move_vertices = false;
    whole.refine.shadows = false;  // another test traces them
    reconstruct(whole);
    ReconstructRequest parts = whole;
    parts.output = testing::fresh_folder("resume_mesh_parts");
    parts.stop_after = 3;
    EXPECT_THROW(reconstruct(parts), Interrupted);
    parts.stop_after = 0;
    parts.resume = true;
    reconstruct(parts);
    EXPECT_EQ(read_bytes(whole.output / "model.glb"), read_bytes(parts.output / "model.glb"));
}

TEST(Reconstruct, AModelSaysWhatItWasComputedFrom) {
    const fs::path dataset = sphere_dataset("claim", 6, 2, 32);
    ReconstructRequest request = short_request(dataset, "claim_out");
    request.mesh = dataset / "sphere.glb";
    request.move_vertices = request.refine.shadows = false;
    setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
    reconstruct(request);
    const FileProvenance provenance = read_provenance(request.output / "model.glb");
    EXPECT_TRUE(provenance.is_unchanged());
    EXPECT_EQ(provenance.images.size(), 3u);
    const std::vector<EditClaim> edits = edits_of(provenance.metadata.claim);
    ASSERT_EQ(edits.size(), 1u);
    EXPECT_TRUE(is_reconstruction(edits[0]));
    EXPECT_EQ(edits[0].photographs, "6");
    EXPECT_EQ(edits[0].input, dataset.filename().string());
    EXPECT_EQ(edits[0].date, "2023-11-14T22:13:20Z");
    // Datasets of this layout hold renders, so the model claims no source type.
    EXPECT_EQ(provenance.metadata.source_type, "");
    request.output = testing::fresh_folder("claim_off");
    request.says_provenance = false;
    reconstruct(request);
    EXPECT_FALSE(read_provenance(request.output / "model.glb").has_claim());
}

TEST(Reconstruct, TexturesAreAsFineAsThePhotographs) {
    // The square is 2 x 2.
    const Model model = plain_model(
        at::tensor({-1.0f, -1.0f, 0.0f, 1.0f, -1.0f, 0.0f, 1.0f, 1.0f, 0.0f, -1.0f, 1.0f, 0.0f})
            .reshape({4, 3}),
        at::tensor({0, 1, 2, 0, 2, 3}, at::kLong).reshape({2, 3}));
    EXPECT_EQ(texture_size_for(model, 0.02f), 1024);
    EXPECT_EQ(texture_size_for(model, 0.003f), 2048);
    EXPECT_EQ(texture_size_for(model, 0.0001f), 4096);
}

TEST(Reconstruct, ThePreviewShowsPhotographsAndWhatThereIs) {
    const fs::path dataset_folder = sphere_dataset("preview", 6, 2, 32);
    const Dataset dataset = load_dataset(dataset_folder);
    const fs::path picture = testing::fresh_folder("preview_out") / "preview.png";
    StagePreview preview(picture, dataset);
    const Model model = load_plain_model(dataset_folder / "sphere.glb");
    const auto views = make_targets(dataset.train, model.bounds());
    Appearance appearance = make_appearance(model.bounds(), views, AppearanceStart::smooth, 0);
    MovableMesh mesh(model, false);
    RefineOptions options;
    options.shadows = false;
    ViewCorrections corrections(dataset.train, dataset.centre, dataset.radius, {});
    Refinement stage(appearance, corrections, mesh, model, views, options);
    stage.step();
    preview.update(stage);
    const Image image = load_image(picture);
    EXPECT_EQ(image.width, 3 * 32);
    EXPECT_EQ(image.height, 3 * 32);
    // In each column, the photograph and the render below it begin and end at the same places.
    for (const int x : {0, 16, 31}) {
        const float paper = image.at(0, 0, 0);
        const bool in_photograph = std::abs(image.at(x, 16, 2) - paper) > 0.02f;
        const bool in_drawing = std::abs(image.at(x, 48, 2) - paper) > 0.02f;
        EXPECT_EQ(in_photograph, x == 16);
        EXPECT_EQ(in_drawing, x == 16);
    }
    // Landscape and portrait images are shown side by side.
    Dataset mixed = dataset;
    mixed.train[2].image = Image(32, 24, 4, 0.5f);
    StagePreview(picture, mixed).update(stage);
    EXPECT_EQ(load_image(picture).height, 3 * 32);
    // A preview that cannot be written stops nothing.
    fs::remove_all(picture.parent_path());
    StagePreview(picture / "below" / "nothing.png", dataset).update(stage);
}

TEST(Reconstruct, AConstantFieldIsTheMaterialOfThePlainModel) {
    NeuralTextureOptions options;
    options.ranges = reconstruction_ranges();
    NeuralTexture field = constant_field(options);
    Model model = striped_sphere();
    set_constant_material(model, options.ranges);
    const MaterialSample sample = field->forward(at::rand({20, 3}) - 0.5f);
    const Material& material = model.materials[0];
    EXPECT_NEAR(sample.base_color.min().item<float>(), material.base_color_factor.x, 1e-5);
    EXPECT_NEAR(sample.base_color.max().item<float>(), material.base_color_factor.x, 1e-5);
    EXPECT_NEAR(sample.orm[7][1].item<float>(), material.roughness_factor, 1e-6);
    EXPECT_NEAR(sample.orm[7][2].item<float>(), material.metallic_factor, 1e-6);
    EXPECT_NEAR(sample.normal[3][2].item<float>(), 1, 1e-6);
}

TEST(Refine, LossesSeeWhatTheyShould) {
    const at::Tensor target = at::full({1, 4, 4, 4}, 0.5f);
    at::Tensor same = target.clone();
    const at::Tensor background = at::full({3}, 0.2f);
    EXPECT_EQ(image_loss(same, target, background).item<float>(), 0);
    EXPECT_EQ(mask_loss(same, target).item<float>(), 0);
    same.narrow(3, 0, 3).fill_(0.7f);
    EXPECT_GT(image_loss(same, target, background).item<float>(), 0.02f);
    // Where a photograph is white, a value above its range counts as right.
    at::Tensor white = at::ones({1, 4, 4, 4}), brighter = white.clone();
    brighter.narrow(3, 0, 3).fill_(5.0f);
    EXPECT_EQ(image_loss(brighter, white, background).item<float>(), 0);

    TrainableLight light(16, 0.5f);
    EXPECT_NEAR(light.whiteness_loss().item<float>(), 0, 1e-6);
    {
        const at::NoGradGuard no_gradient;
        light.parameters().front().select(2, 0).add_(1.0f);
    }
    EXPECT_GT(light.whiteness_loss().item<float>(), 0.1f);
    light.prefiltered().diffuse.sum().backward();
    for (const at::Tensor& level : light.parameters())
        EXPECT_GT(level.grad().abs().min().item<float>(), 0);
    // Without colour, all channels get the same gradient.
    light.radiance().select(2, 0).sum().backward();
    light.take_color_from_gradients();
    for (const at::Tensor& level : light.parameters())
        EXPECT_TRUE(level.grad().select(2, 0).equal(level.grad().select(2, 2)));
}

TEST(MovableMesh, SeamsMoveAsOne) {
    Model model = striped_sphere();
    MovableMesh mesh(model, true);
    const std::int64_t places = mesh.offsets().size(0);
    EXPECT_LT(places, static_cast<std::int64_t>(model.primitives[0].positions.size()));
    EXPECT_NEAR(mesh.crumpling().item<float>(), 0, 1e-9);
    {
        const at::NoGradGuard no_gradient;
        mesh.offsets().add_(at::tensor({0.1f, 0.0f, 0.0f}));
    }
    EXPECT_NEAR(mesh.crumpling().item<float>(), 0, 1e-6);  // moved as one
    const Model moved = mesh.apply(model);
    for (std::size_t v = 0; v < moved.primitives[0].positions.size(); ++v)
        EXPECT_NEAR(moved.primitives[0].positions[v].x, model.primitives[0].positions[v].x + 0.1f,
                    1e-5);
    mesh.geometry().positions.sum().backward();
    EXPECT_GT(mesh.offsets().grad().min().item<float>(), 0);
}

}  // namespace
}  // namespace item3d
