// Tests of find_poses() with a stand-in for COLMAP.
#include "item3d/reconstruct/dataset/find_poses.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "tests/support/exif.h"
#include "tests/support/reconstruct.h"

#include <fmt/format.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>

namespace item3d {
namespace {

using testing::disk_image;
using testing::fresh_folder;
namespace fs = std::filesystem;

/// Fixture: a folder of images, and a script named colmap that comes first in PATH.
class FindPoses : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fresh_folder(::testing::UnitTest::GetInstance()->current_test_info()->name());
        path_ = std::getenv("PATH");
        ::setenv("PATH", ((folder_ / "bin").string() + ":/usr/bin:/bin").c_str(), 1);
        search_ = {folder_ / "photos", {}, folder_ / "out", 2};
        add_images(5);
    }
    void TearDown() override { ::setenv("PATH", path_.c_str(), 1); }

    void add_images(int count, int width = 24) {
        fs::create_directories(search_.images);
        for (int i = 0; i < count; ++i)
            save_image(search_.images / fmt::format("{}.png", i), disk_image(width, 24));
    }

    /// Returns commands by which the script outputs poses of the first `count` images.
    std::string model_of(int count) const {
        const fs::path model = folder_ / "model";
        fs::create_directories(model);
        std::string images;
        for (int i = 0; i < count; ++i) {
            // The cameras turn about the world's y axis, which points down in COLMAP, and look at
            // the origin.
            images += fmt::format("{} {} 0 {} 0 0 0 4 1 {}.png\n\n", i + 1, std::cos(0.4 * i),
                                  std::sin(0.4 * i), i);
        }
        write_atomically(model / "cameras.txt",
                         std::string_view("1 SIMPLE_RADIAL 24 24 30 12 12 0\n"));
        write_atomically(model / "images.txt", std::string_view(images));
        return fmt::format("mapper) mkdir \"$output/0\"; cp {}/* \"$output/0\";;\n",
                           model.string());
    }

    /// Installs the script. `cases` are the branches of a shell's `case` on the command. `help` is
    /// the list of options that the script prints.
    void install(const std::string& cases, const std::string& help = "") const {
        const fs::path program = folder_ / "bin" / "colmap";
        fs::create_directories(program.parent_path());
        std::ofstream(program) << fmt::format(
            "#!/bin/sh\n"
            "[ \"$2\" = -h ] && {{ echo '{}'; exit 0; }}\n"
            "echo \"$@\" >> {}/calls\n"
            "command=$1 all=\"$*\" here={}\n"
            "while [ $# -gt 0 ]; do case $1 in --output_path) output=$2;; esac; shift; done\n"
            "case $command in\n{}esac\n",
            help, folder_.string(), folder_.string(), cases);
        fs::permissions(program, fs::perms::owner_all);
    }

    std::string calls() const { return read_text(folder_ / "calls"); }

    template <typename Thrown>
    std::string message() const {
        try {
            find_poses(search_);
        } catch (const Thrown& error) {
            return error.what();
        }
        ADD_FAILURE() << "nothing was thrown";
        return {};
    }

    /// Returns the messages that find_poses() writes to stderr.
    std::string said() const {
        ::testing::internal::CaptureStderr();
        find_poses(search_);
        return ::testing::internal::GetCapturedStderr();
    }

    fs::path folder_;
    std::string path_;
    PoseSearch search_;
};

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

int count_of(const std::string& text, const std::string& part) {
    int count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

TEST_F(FindPoses, AreADataset) {
    write_atomically(search_.images / "notes.txt", std::string_view("of the day"));
    write_atomically(search_.images / "broken.jpg", std::string_view("no picture"));
    install(model_of(5));
    const std::string text = said();
    EXPECT_TRUE(has(text, "broken.jpg: is not a PNG or JPEG image")) << text;
    EXPECT_TRUE(has(text, "the poses of all 5 images")) << text;
    DatasetOptions options;
    options.images = search_.images;
    const Dataset dataset = load_dataset(folder_ / "out" / "colmap", options);
    EXPECT_EQ(dataset.kind, DatasetKind::colmap);
    EXPECT_EQ(dataset.train.size(), 5u);
    EXPECT_EQ(dataset.masks, "alpha");
    EXPECT_TRUE(fs::exists(folder_ / "out" / "colmap" / "colmap.log"));
    EXPECT_FALSE(fs::exists(folder_ / "out" / "colmap.partial"));
    EXPECT_FALSE(fs::exists(folder_ / "out" / "colmap.log"));
    EXPECT_TRUE(has(calls(), "feature_extractor")) << calls();
    EXPECT_TRUE(has(calls(), "--ImageReader.single_camera 1")) << calls();
    EXPECT_TRUE(has(calls(), "--SiftExtraction.use_gpu 0 --SiftExtraction.num_threads 2"));
    EXPECT_TRUE(has(calls(), "exhaustive_matcher")) << calls();
    EXPECT_FALSE(has(calls(), "mask_path")) << calls();
}

TEST_F(FindPoses, OptionsAreNamedAsTheProgramHasThem) {
    add_images(1, 32);
    search_.masks = folder_ / "masks";
    fs::create_directories(search_.masks);
    for (int i = 0; i < 5; ++i)
        save_image(search_.masks / fmt::format("{}.png.png", i), disk_image(i ? 24 : 32, 24));
    install(model_of(5), "--FeatureExtraction.use_gpu --FeatureMatching.use_gpu");
    find_poses(search_);
    EXPECT_TRUE(has(calls(), "--FeatureExtraction.use_gpu 0 --SiftExtraction.num_threads 2"));
    EXPECT_TRUE(has(calls(), "--FeatureMatching.use_gpu 0")) << calls();
    EXPECT_EQ(count_of(calls(), "--ImageReader.single_camera 1"), 2) << "one run a size";
    EXPECT_TRUE(has(calls(), "--ImageReader.mask_path " + search_.masks.string())) << calls();
}

TEST_F(FindPoses, ImagesOfOneLensShareIt) {
    const Image image(40, 30, 3, 0.5f);
    for (int i = 0; i < 5; ++i)
        testing::save_photograph(search_.images / fmt::format("{}.jpg", i), image,
                                 {.focal_35 = i % 2 == 0 ? 26 : 52, .camera = "Telephone 7"});
    const std::string pngs = model_of(5);
    install(pngs);
    find_poses(search_);
    // The telephone has two lenses, and the images without EXIF count as a third.
    EXPECT_EQ(count_of(calls(), "feature_extractor"), 3) << calls();
    EXPECT_EQ(count_of(calls(), "--ImageReader.single_camera 1"), 3);
    EXPECT_TRUE(has(calls(), "--ImageReader.camera_params 30.05,20,15,0")) << calls();
    EXPECT_TRUE(has(calls(), "--ImageReader.camera_params 60.09,20,15,0")) << calls();
    EXPECT_EQ(count_of(calls(), "camera_params"), 2);
    // Each image is cropped by hand to its own size, so each has its own lens, in one run.
    for (int i = 0; i < 12; ++i)
        save_image(search_.images / fmt::format("cut_{}.png", i), disk_image(24 + i, 30));
    fs::remove(folder_ / "calls");
    find_poses(search_);
    EXPECT_EQ(count_of(calls(), "feature_extractor"), 1) << calls();
    EXPECT_TRUE(has(calls(), "--ImageReader.single_camera 0")) << calls();
}

TEST_F(FindPoses, WhereMasksHideTooMuchTheSurroundingsAreLookedAt) {
    search_.masks = folder_ / "masks";
    fs::create_directories(search_.masks);
    for (int i = 0; i < 5; ++i)
        save_image(search_.masks / fmt::format("{}.png.png", i), disk_image(24, 24));
    // No poses are found from features of the object alone.
    const std::string model = model_of(4);
    install(
        "feature_extractor) echo \"$all\" | grep -q mask_path && touch $here/masked || "
        "rm -f $here/masked;;\n"
        "mapper) [ -e $here/masked ] || { mkdir \"$output/0\"; cp $here/model/* "
        "\"$output/0\"; };;\n");
    const std::string text = said();
    EXPECT_TRUE(has(text, "COLMAP found 0 of 5 poses within the masks")) << text;
    EXPECT_TRUE(has(text, "poses were found for 4 of 5 images")) << text;
    EXPECT_EQ(count_of(calls(), "mask_path"), 1) << calls();
    EXPECT_FALSE(fs::exists(folder_ / "out" / "colmap.partial"));
    EXPECT_FALSE(fs::exists(folder_ / "out" / "colmap.again"));
    EXPECT_TRUE(has(said(), "are reused"));
}

TEST_F(FindPoses, ATelephonesOwnFormatIsNamed) {
    for (int i = 1; i < 5; ++i)
        fs::remove(search_.images / fmt::format("{}.png", i));
    for (int i = 0; i < 4; ++i)
        write_atomically(search_.images / fmt::format("IMG_{}.HEIC", i), std::string_view("heic"));
    EXPECT_TRUE(has(
        message<InputError>(),
        "1 PNG or JPEG image(s); it contains 4 HEIC or DNG images: convert them to JPEG first"));
}

TEST_F(FindPoses, ManyImagesAreMatchedInTheirOrder) {
    for (int i = 5; i < 151; ++i)
        fs::copy_file(search_.images / "0.png", search_.images / fmt::format("{}.png", i));
    install(model_of(151));
    find_poses(search_);
    EXPECT_TRUE(has(calls(), "sequential_matcher")) << calls();
}

TEST_F(FindPoses, AreTakenAgainForTheSameImages) {
    install(model_of(5));
    EXPECT_EQ(find_poses(search_), folder_ / "out" / "colmap");
    const std::string before = calls();
    EXPECT_TRUE(has(said(), "are reused"));
    EXPECT_EQ(calls(), before);
    // Reusing poses requires no program.
    fs::remove(folder_ / "bin" / "colmap");
    ::setenv("PATH", (folder_ / "bin").c_str(), 1);
    EXPECT_TRUE(has(said(), "are reused"));
    // Other images start a new search.
    ::setenv("PATH", ((folder_ / "bin").string() + ":/usr/bin:/bin").c_str(), 1);
    save_image(search_.images / "4.png", disk_image(24, 24, 0.2f));
    install(model_of(4));
    EXPECT_TRUE(has(said(), "poses were found for 4 of 5 images; left out: 4.png"));
    EXPECT_NE(calls(), before);
}

TEST_F(FindPoses, AFolderOfSomebodyElseIsLeftAlone) {
    install(model_of(5));
    fs::create_directories(folder_ / "out" / "colmap");
    EXPECT_TRUE(has(message<InputError>(), "was not written by a pose estimation"));
    EXPECT_FALSE(fs::exists(folder_ / "calls"));
}

TEST_F(FindPoses, AMissingProgramIsSaidBeforeAnythingIsWritten) {
    ::setenv("PATH", (folder_ / "bin").c_str(), 1);
    EXPECT_TRUE(has(message<ResourceError>(), "colmap was not found; install it"));
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    // A file that is not executable is no program.
    install(model_of(5));
    fs::permissions(folder_ / "bin" / "colmap", fs::perms::owner_read);
    EXPECT_TRUE(has(message<ResourceError>(), "colmap was not found"));
}

TEST_F(FindPoses, AFailureIsToldByItsLine) {
    install(
        "feature_extractor) echo 'ERROR: of a step before';;\n"
        "exhaustive_matcher) echo 'Matching block [1/1, 1/1]';\n"
        "  echo 'F20260101 12:00:00.000000 12 cache.h:132] Check failed: 0 > 0' >&2;\n"
        "  echo '*** Check failure stack trace: ***'; echo '    @ 0x1234 main'; exit 3;;\n");
    const std::string text = message<ResourceError>();
    EXPECT_TRUE(has(text, "colmap exhaustive_matcher failed (exit code 3): Check failed: 0 > 0;"))
        << text;
    EXPECT_TRUE(has(text, (folder_ / "out" / "colmap.log").string())) << text;
    EXPECT_TRUE(has(read_text(folder_ / "out" / "colmap.log"), "Matching block"));
    EXPECT_FALSE(fs::exists(folder_ / "out" / "colmap"));
    EXPECT_FALSE(fs::exists(folder_ / "out" / "colmap.partial"));
    install("feature_extractor) echo 'Processed file [1/5]'; kill -9 $$;;\n");
    EXPECT_TRUE(has(message<ResourceError>(), "was ended by signal 9"));
}

TEST_F(FindPoses, ImagesThatDoNotSufficeAreRefused) {
    install("mapper) echo 'ERROR: failed to create sparse model'; exit 1;;\n");
    EXPECT_TRUE(has(message<InputError>(), "no poses were found"));
    EXPECT_FALSE(fs::exists(folder_ / "out" / "colmap"));
    install("");  // a version that does not report a failure
    EXPECT_TRUE(has(message<InputError>(), "no poses were found"));
    install(model_of(2));
    EXPECT_TRUE(has(message<InputError>(), "poses were found for only 2 of 5 images"));
    EXPECT_FALSE(fs::exists(folder_ / "out" / "colmap"));

    for (int i = 2; i < 5; ++i)
        fs::remove(search_.images / fmt::format("{}.png", i));
    EXPECT_TRUE(has(message<InputError>(), "2 PNG or JPEG image(s)"));
    search_.images = folder_ / "nowhere";
    EXPECT_TRUE(has(message<InputError>(), "is not a folder of images"));
}

TEST_F(FindPoses, AnInterruptEndsTheProgramAndLeavesNothing) {
    install(fmt::format("feature_extractor) echo $$ > {}/id; kill -INT $PPID; exec sleep 60;;\n",
                        folder_.string()));
    const auto interrupted_search = [&] {
        install_interrupt_handler();
        try {
            find_poses(search_);
        } catch (const Interrupted& error) {
            std::_Exit(static_cast<int>(error.code()));
        }
    };
    EXPECT_EXIT(interrupted_search(), ::testing::ExitedWithCode(130), "");
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    const int id = std::stoi(read_text(folder_ / "id"));
    EXPECT_NE(::kill(id, 0), 0) << "the program still runs";
}

}  // namespace
}  // namespace item3d
