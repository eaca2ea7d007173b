#include "tests/fuzz/replay.h"

namespace item3d {
namespace {

const std::filesystem::path test_data = ITEM3D_TEST_DATA, fuzz_folder = test_data / "../fuzz";

/// Returns the targets that read files with this extension.
std::vector<std::string> targets_of(const std::string& ending) {
    static const std::multimap<std::string, std::string> targets = {
        {".glb", "gltf"},     {".gltf", "gltf"},         {".obj", "obj"},
        {".mtl", "mtl"},      {".png", "png"},           {".png", "image_packet"},
        {".jpg", "jpeg"},     {".jpg", "image_packet"},  {".webp", "webp"},
        {".ktx2", "ktx2"},    {".ktx2", "image_packet"}, {".hdr", "radiance"},
        {".exr", "openexr"},  {".tif", "tiff"},          {".bmp", "stb"},
        {".tga", "stb"},      {".gif", "stb"},           {".json", "cameras"},
        {".csv", "job_rows"}, {".txt", "light_words"},   {".webp", "image_packet"}};
    std::vector<std::string> names;
    const auto [first, last] = targets.equal_range(ending);
    for (auto entry = first; entry != last; ++entry)
        names.push_back(entry->second);
    return names;
}

// The folder corpus/TARGET has inputs each of which once failed. A failure here ends the program.
TEST(Fuzz, WhatOnceFailedIsReadOrRefused) {
    ASSERT_FALSE(fuzz::all_targets().empty());
    fuzz::expect_names_of_targets(fuzz_folder / "corpus");
    fuzz::for_files_of_targets(fuzz_folder / "corpus",
                               [](const std::string& target, const std::filesystem::path& file) {
                                   SCOPED_TRACE(file.string());
                                   fuzz::replay(target, fuzz::bytes_of(file));
                               });
}

// Small files of the tests are read whole, cut off, and with a changed bit at many places.
TEST(Fuzz, DamagedFilesAreReadOrRefused) {
    std::map<std::string, int> inputs;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(test_data)) {
        if (!entry.is_regular_file() || entry.file_size() > 20000) continue;
        for (const std::string& name : targets_of(entry.path().extension().string()))
            inputs[name] += fuzz::replay_damaged(name, entry.path(), 16);
    }
    for (const std::string name : {"gltf", "obj", "mtl", "png", "ktx2", "radiance", "openexr"})
        EXPECT_GE(inputs[name], 16) << name;
}

// Files of seeds/TARGET are damaged in the same way. They serve targets for which the tests have no
// files.
TEST(Fuzz, DamagedSeedsAreReadOrRefused) {
    fuzz::expect_names_of_targets(fuzz_folder / "seeds");
    int inputs = 0;
    fuzz::for_files_of_targets(fuzz_folder / "seeds",
                               [&](const std::string& target, const std::filesystem::path& file) {
                                   inputs += fuzz::replay_damaged(target, file, 16);
                               });
    EXPECT_GE(inputs, 16 * 60);
}

}  // namespace
}  // namespace item3d
