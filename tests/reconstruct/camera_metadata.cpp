// Tests of reading and using the EXIF data of telephones.
#include "item3d/reconstruct/dataset/camera_metadata.h"

#include "item3d/core/error.h"
#include "item3d/reconstruct/dataset/orientation.h"
#include "item3d/reconstruct/surface/view_corrections.h"
#include "tests/support/exif.h"
#include "tests/support/reconstruct.h"

#include <cmath>

namespace item3d {
namespace {

using nlohmann::json;
using testing::fresh_folder;
using testing::ring_of_cameras;
using testing::rows_of;
using testing::save_photograph;
using testing::WrittenMetadata;
namespace fs = std::filesystem;

const WrittenMetadata telephone{.orientation = 6,
                                .focal_35 = 26,
                                .focal = 4.2,
                                .seconds = 0.02,
                                .aperture = 1.8,
                                .sensitivity = 200,
                                .shutter = {},
                                .camera = "Telephone 7",
                                .width = 4000,
                                .height = 3000};

/// Returns an image as it is shown: a white disk above the middle, on black. JPEG changes it
/// little.
Image disk_above(int width, int height) {
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) =
                    std::hypot(x + 0.5 - 0.5 * width, y + 0.5 - 0.3 * height) < 0.2 * height ? 1.0f
                                                                                             : 0.0f;
    return image;
}

TEST(CameraMetadata, AreReadInBothByteOrders) {
    const fs::path folder = fresh_folder("facts");
    for (const bool big_endian : {false, true}) {
        save_photograph(folder / "a.jpg", Image(8, 6, 3, 0.5f), telephone, big_endian);
        const CameraMetadata metadata = camera_metadata(folder / "a.jpg");
        EXPECT_EQ(metadata.orientation, 6);
        EXPECT_EQ(metadata.focal_35, 26);
        EXPECT_NEAR(metadata.focal, 4.2, 1e-9);
        EXPECT_NEAR(metadata.exposure, 0.02 * 2 / (1.8 * 1.8), 1e-9);
        EXPECT_EQ(metadata.camera, "Telephone 7");
        EXPECT_EQ(metadata.width, 4000);
        EXPECT_EQ(metadata.height, 3000);
    }
    const std::optional<ImageSize> size = stored_size(read_bytes(folder / "a.jpg"));
    ASSERT_TRUE(size);
    EXPECT_EQ(size->width, 8);
    EXPECT_EQ(size->height, 6);
}

TEST(CameraMetadata, WhatIsNotThereIsNotSaid) {
    const fs::path folder = fresh_folder("no_facts");
    save_image(folder / "plain.jpg", Image(8, 6, 3, 0.5f));
    save_image(folder / "plain.png", Image(8, 6, 3, 0.5f));
    for (const char* name : {"plain.jpg", "plain.png", "missing.jpg"}) {
        const CameraMetadata metadata = camera_metadata(folder / name);
        EXPECT_EQ(metadata.orientation, 1);
        EXPECT_EQ(metadata.focal_35, 0);
        EXPECT_EQ(metadata.exposure, 0);
    }
    // Exposure times without a sensitivity cannot be compared. A time may be given as a logarithm.
    save_photograph(folder / "a.jpg", Image(8, 6, 3, 0.5f), {.seconds = 0.02});
    EXPECT_EQ(camera_metadata(folder / "a.jpg").exposure, 0);
    save_photograph(folder / "a.jpg", Image(8, 6, 3, 0.5f), {.sensitivity = 100, .shutter = 3.0});
    EXPECT_NEAR(camera_metadata(folder / "a.jpg").exposure, 0.125, 1e-9);
    save_photograph(folder / "a.jpg", Image(8, 6, 3, 0.5f), {.orientation = 11});
    EXPECT_EQ(camera_metadata(folder / "a.jpg").orientation, 1);
    // A file that is truncated anywhere causes no crash.
    save_photograph(folder / "a.jpg", Image(8, 6, 3, 0.5f), telephone);
    const Bytes whole = read_bytes(folder / "a.jpg");
    for (std::size_t length = 0; length < 320; ++length)
        camera_metadata(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)));
}

TEST(CameraMetadata, FocalLengthsAreByTheDiagonal) {
    const CameraMetadata metadata{.focal_35 = 43.266615, .width = 4000, .height = 3000};
    EXPECT_NEAR(focal_in_pixels(metadata, 400, 300), 500, 1e-3);
    EXPECT_NEAR(focal_in_pixels(metadata, 300, 400), 500, 1e-3);
    EXPECT_EQ(focal_in_pixels(metadata, 400, 200), 0) << "it was cropped";
    EXPECT_EQ(focal_in_pixels({}, 400, 300), 0);
}

TEST(CameraMetadata, TransformsWithoutALensTakeEachImagesOwn) {
    const fs::path folder = fresh_folder("exif_lens");
    json document{{"frames", json::array()}};
    for (const Camera& camera : ring_of_cameras(4)) {
        const std::string name = camera.name + ".jpg";
        document["frames"].push_back(
            {{"file_path", name}, {"transform_matrix", rows_of(camera.camera_to_world)}});
        // One telephone is held upright, so its stored image is wider than high.
        const bool upright = camera.name == "view_2";
        save_photograph(folder / name, disk_above(40, 30),
                        {.orientation = upright ? 8 : 1, .focal_35 = 50});
    }
    const auto load = [&] {
        write_atomically(folder / "transforms.json", std::string_view(document.dump()));
        ::testing::internal::CaptureStderr();
        Dataset dataset = load_dataset(folder);
        return std::pair(std::move(dataset), ::testing::internal::GetCapturedStderr());
    };
    const auto [dataset, said] = load();
    EXPECT_NE(said.find("4 focal lengths were read from EXIF"), std::string::npos);
    const double focal = 50 / 43.266615 * 50;  // the image's diagonal has 50 pixels
    ASSERT_EQ(dataset.train.size(), 4u);
    for (const Photograph& view : dataset.train) {
        const bool upright = view.name == "view_2";
        EXPECT_EQ(view.image.width, upright ? 30 : 40);
        EXPECT_NEAR(view.camera.field_of_view_x, 2 * std::atan(0.5 * view.image.width / focal),
                    1e-4);
    }
    save_image(folder / "view_1.jpg", disk_above(40, 30));
    try {
        load_dataset(folder);
        ADD_FAILURE() << "a lens was made up";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("there is no EXIF focal length in view_1.jpg"),
                  std::string::npos)
            << error.what();
    }
}

/// Images from a camera that is held upright, stored in landscape, with COLMAP's poses of the
/// stored images.
struct HeldCameras {
    fs::path folder;
    json document;
};

HeldCameras held_cameras(const std::string& name, int orientation, bool masks_as_shown) {
    HeldCameras held{fresh_folder(name), {{"w", 40}, {"h", 30}, {"fl_x", 50}}};
    fs::create_directories(held.folder / "masks");
    held.document["frames"] = json::array();
    const bool swaps = swaps_sides(orientation);
    const Image shown = swaps ? disk_above(30, 40) : disk_above(40, 30);
    const Image stored = oriented(shown, inverse_orientation(orientation));
    for (const Camera& camera : ring_of_cameras(4)) {
        const std::string file = camera.name + ".jpg";
        save_photograph(held.folder / file, stored, {.orientation = orientation});
        save_image(held.folder / "masks" / (file + ".png"), masks_as_shown ? shown : stored);
        held.document["frames"].push_back(
            {{"file_path", file},
             {"transform_matrix",
              rows_of(oriented_camera(camera.camera_to_world, inverse_orientation(orientation)))}});
    }
    write_atomically(held.folder / "transforms.json", std::string_view(held.document.dump()));
    return held;
}

TEST(CameraMetadata, UpIsWhereTheCameraHadItNotWhereTheImageLies) {
    for (const int orientation : {1, 3, 6, 8}) {
        const HeldCameras held = held_cameras("held", orientation, false);
        const Dataset dataset = load_dataset(held.folder);
        const std::vector<Camera> cameras = ring_of_cameras(4);
        ASSERT_EQ(dataset.train.size(), 4u);
        EXPECT_LT(glm::length(dataset.world_from_dataset * Vec3(0, 1, 0) - Vec3(0, 1, 0)), 1e-5f)
            << orientation;
        for (std::size_t i = 0; i < 4; ++i) {
            const Photograph& view = dataset.train[i];
            for (int c = 0; c < 4; ++c)
                EXPECT_LT(
                    glm::length(view.camera.camera_to_world[c] - cameras[i].camera_to_world[c]),
                    1e-5f)
                    << orientation;
            EXPECT_EQ(view.image.width, swaps_sides(orientation) ? 30 : 40);
            EXPECT_NEAR(view.camera.field_of_view_x, 2 * std::atan(view.image.width / 100.0), 1e-5);
            const int x = view.image.width / 2, y = view.image.height * 3 / 10;
            EXPECT_GT(view.image.at(x, y, 0), 0.9f) << orientation;
            EXPECT_GT(view.image.at(x, y, 3), 0.9f) << orientation;
            EXPECT_LT(view.image.at(x, view.image.height - 4, 3), 0.1f) << orientation;
        }
    }
}

TEST(CameraMetadata, MasksMayLieAsImagesAreShown) {
    const Dataset as_stored = load_dataset(held_cameras("masks_stored", 6, false).folder);
    const Dataset as_shown = load_dataset(held_cameras("masks_shown", 6, true).folder);
    EXPECT_EQ(as_stored.train[0].image.pixels, as_shown.train[0].image.pixels);
}

TEST(CameraMetadata, GainsBeginAsExposuresAre) {
    std::vector<Photograph> views;
    for (const Camera& camera : ring_of_cameras(5))
        views.push_back({camera.name, camera, testing::disk_image(24, 24), 0});
    const auto gains = [&](bool exposure) {
        const ViewCorrections corrections(views, Vec3(0.0f), 1, {.exposure = exposure});
        return corrections.gains();
    };
    EXPECT_TRUE(gains(true).equal(at::ones({5, 3})));
    const std::array<double, 5> exposures{0.008, 0.01, 0.02, 0.005, 0.01};
    for (std::size_t i = 0; i < 5; ++i)
        views[i].exposure = exposures[i];
    const at::Tensor found = gains(true);
    for (std::int64_t i = 0; i < 5; ++i)
        for (std::int64_t c = 0; c < 3; ++c)
            EXPECT_NEAR(found[i][c].item<float>(), exposures[static_cast<std::size_t>(i)] / 0.01,
                        1e-5);
    EXPECT_TRUE(gains(false).equal(at::ones({5, 3})));
    views[3].exposure = 0;  // one exposure is unknown, so none is used
    EXPECT_TRUE(gains(true).equal(at::ones({5, 3})));
}

}  // namespace
}  // namespace item3d
