// Tests of uploaded folders of photographs: the structure is kept, and names become safe.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/studio/folders.h"
#include "item3d/studio/photograph_upload.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace item3d::testing {
namespace {

namespace fs = std::filesystem;

class StudioPhotographs : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("item3d_photographs_" + std::to_string(::getpid()));
        fs::remove_all(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    static void add(PhotographUpload& upload, const std::string& name, const std::string& content,
                    const std::string& field = "photographs") {
        upload.begin(field, name);
        upload.add(content.data(), content.size());
    }

    fs::path folder_;
};

TEST(StudioPaths, KeepFoldersAndLeadNowhere) {
    EXPECT_EQ(stored_path("train/r_0.PNG"), "train/r_0.png");
    EXPECT_EQ(stored_path("./train\\r_0"), "train/r_0");
    EXPECT_EQ(stored_path("../../etc/passwd.jpg"), "etc/passwd.jpg");
    EXPECT_EQ(stored_path("a/b/c/d/e.jpg"), "b/c/d/e.jpg");
    EXPECT_EQ(stored_path("../.."), "file");
    EXPECT_EQ(stored_path("/"), "file");
}

TEST_F(StudioPhotographs, StayWhereTheyLay) {
    PhotographUpload upload(folder_, 1000);
    add(upload, "train/my photo.PNG", "one");
    add(upload, "test/my photo.PNG", "two");
    add(upload, "masks/my photo.png", "three");
    add(upload, "other.png", "four", "masks");
    add(upload, "transforms_train.json",
        R"({"camera_angle_x": 1, "frames": [{"file_path": "./train/my photo", "mask_path": "masks/my photo.png"}]})");
    upload.end();
    EXPECT_EQ(upload.count(), 5u);
    const auto transforms = nlohmann::json::parse(read_text(folder_ / "transforms_train.json"));
    const auto& frame = transforms["frames"][0];
    const std::string path = frame["file_path"];
    EXPECT_EQ(read_text(folder_ / (path + ".png")), "one");
    EXPECT_EQ(read_text(folder_ / frame["mask_path"].get<std::string>()), "three");
    EXPECT_EQ(read_text(folder_ / "masks/other.png"), "four");
    EXPECT_EQ(transforms["camera_angle_x"], 1);
}

TEST_F(StudioPhotographs, AreRefusedWhereTheyAreNoneOrTooMuch) {
    PhotographUpload upload(folder_, 10);
    EXPECT_THROW(upload.begin("photographs", "program.sh"), InputError);
    add(upload, "a.png", "12345");
    EXPECT_THROW(upload.begin("photographs", "a.PNG"), InputError) << "the same name";
    EXPECT_THROW(add(upload, "b.png", "123456"), InputError) << "all together are too large";
}

}  // namespace
}  // namespace item3d::testing
