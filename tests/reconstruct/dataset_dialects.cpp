// Tests of datasets as various programs write them.
#include "item3d/core/error.h"
#include "tests/support/reconstruct.h"

#include <fmt/format.h>

#include <cmath>

namespace item3d {
namespace {

using nlohmann::json;
using testing::disk_image;
using testing::fresh_folder;
using testing::ring_of_cameras;
using testing::rows_of;
namespace fs = std::filesystem;

/// Writes images into `images` and returns a transforms.json for them, with a lens of 24 x 24
/// pixels.
json dialect_document(const fs::path& folder, int count) {
    json document = {{"w", 24}, {"h", 24}, {"fl_x", 30}, {"frames", json::array()}};
    fs::create_directories(folder / "images");
    for (const Camera& camera : ring_of_cameras(count)) {
        document["frames"].push_back({{"file_path", "images/" + camera.name + ".png"},
                                      {"transform_matrix", rows_of(camera.camera_to_world)}});
        save_image(folder / "images" / (camera.name + ".png"), disk_image(24, 24));
    }
    return document;
}

Dataset load_document(const fs::path& folder, const json& document) {
    write_atomically(folder / "transforms.json", std::string_view(document.dump()));
    DatasetOptions options;
    options.up = "y";
    return load_dataset(folder, options);
}

TEST(DatasetDialects, SeparatorsOfWindowsAreRead) {
    const fs::path folder = fresh_folder("backslashes");
    json document = dialect_document(folder, 4);
    const Dataset plain = load_document(folder, document);
    fs::create_directories(folder / "cut");
    for (json& frame : document["frames"]) {
        const std::string name = fs::path(frame["file_path"].get<std::string>()).filename();
        save_image(folder / "cut" / name, disk_image(24, 24, 0.2f));
        frame["file_path"] = ".\\images\\" + name;
        frame["mask_path"] = "cut\\" + name;
        document["train_filenames"].push_back("images\\" + name);
    }
    const Dataset dataset = load_document(folder, document);
    ASSERT_EQ(dataset.train.size(), 4u);
    EXPECT_EQ(dataset.train[0].name, plain.train[0].name);
    EXPECT_EQ(dataset.masks, "mask_path");
    document["frames"][0]["file_path"] = "..\\secret.png";
    EXPECT_THROW(load_document(folder, document), InputError);
}

TEST(DatasetDialects, MatricesOfThreeRowsAreCompleted) {
    const fs::path folder = fresh_folder("three_rows");
    json document = dialect_document(folder, 4);
    const Dataset whole = load_document(folder, document);
    for (json& frame : document["frames"])
        frame["transform_matrix"].erase(3);
    const Dataset dataset = load_document(folder, document);
    ASSERT_EQ(dataset.train.size(), whole.train.size());
    for (std::size_t i = 0; i < dataset.train.size(); ++i) {
        EXPECT_EQ(dataset.train[i].camera.camera_to_world, whole.train[i].camera.camera_to_world);
    }
    document["frames"][0]["transform_matrix"].erase(2);
    EXPECT_THROW(load_document(folder, document), InputError);
}

TEST(DatasetDialects, FisheyeIsABooleanOrANumber) {
    const fs::path folder = fresh_folder("fisheye");
    json document = dialect_document(folder, 4);
    document["k1"] = 0.3;
    const auto first_pixels = [&](const json& is_fisheye) {
        document["is_fisheye"] = is_fisheye;
        return load_document(folder, document).train.at(0).image.pixels;
    };
    const auto pinhole = first_pixels(false);
    EXPECT_EQ(pinhole, first_pixels(0));
    const auto fisheye = first_pixels(true);
    EXPECT_EQ(fisheye, first_pixels(1));
    EXPECT_NE(pinhole, fisheye);
    EXPECT_THROW(first_pixels("perhaps"), InputError);
}

TEST(DatasetDialects, HeldOutViewsWithoutImagesAreLeftOut) {
    const fs::path folder = fresh_folder("cameras_alone");
    const json document = dialect_document(folder, 6);
    json train = document, test = document;
    train["frames"].erase(train["frames"].begin() + 4, train["frames"].end());
    test["frames"].erase(test["frames"].begin(), test["frames"].begin() + 4);
    for (json& frame : test["frames"])
        frame["file_path"] = "test/" + frame["file_path"].get<std::string>();
    const auto put = [&](const char* name, const json& content) {
        write_atomically(folder / name, std::string_view(content.dump()));
    };
    put("transforms_train.json", train);
    put("transforms_test.json", test);
    ::testing::internal::CaptureStderr();
    Dataset dataset = load_dataset(folder);
    const std::string said = ::testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("2 held-out views have no image"), std::string::npos) << said;
    EXPECT_EQ(dataset.train.size(), 4u);
    EXPECT_TRUE(dataset.test.empty());
    // A split whose images exist is used for testing.
    json val = document;
    val["frames"].erase(val["frames"].begin(), val["frames"].begin() + 5);
    put("transforms_val.json", val);
    dataset = load_dataset(folder);
    ASSERT_EQ(dataset.test.size(), 1u);
    EXPECT_EQ(dataset.test[0].name, "images/view_5");
}

TEST(DatasetDialects, TheLargestOfSeveralColmapModelsIsTaken) {
    const fs::path folder = fresh_folder("colmap_models");
    fs::create_directories(folder / "images");
    const auto write_model = [&](const std::string& place, int first, int count) {
        fs::create_directories(folder / place);
        write_atomically(folder / place / "cameras.txt",
                         std::string_view("1 PINHOLE 24 24 30 30 12 12\n"));
        std::string text;
        for (int i = first; i < first + count; ++i) {
            // The cameras turn about the world's y axis, which points down in COLMAP, and look at
            // the origin.
            const double angle = 0.4 * i;
            const std::string name = std::to_string(i) + ".png";
            text += fmt::format("{} {} 0 {} 0 0 0 4 1 {}\n\n", i + 1, std::cos(angle / 2),
                                std::sin(angle / 2), name);
            save_image(folder / "images" / name, disk_image(24, 24));
        }
        write_atomically(folder / place / "images.txt", std::string_view(text));
    };
    write_model("sparse/0", 0, 4);
    EXPECT_EQ(load_dataset(folder).train.size(), 4u);
    write_model("sparse/1", 4, 7);
    ::testing::internal::CaptureStderr();
    const Dataset dataset = load_dataset(folder);
    const std::string said = ::testing::internal::GetCapturedStderr();
    EXPECT_EQ(dataset.train.size(), 7u);
    EXPECT_NE(said.find("1 with 7 images"), std::string::npos) << said;
    // The model's folder may have any number as its name.
    fs::remove_all(folder / "sparse/0");
    EXPECT_EQ(load_dataset(folder).train.size(), 7u);
}

}  // namespace
}  // namespace item3d
