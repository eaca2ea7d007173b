#include "tests/fuzz/fuzz.h"

#include <gtest/gtest.h>

#include <iterator>
#include <vector>

namespace item3d {
namespace {

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

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

// corpus/TARGET has inputs that failed once; a failure here ends the program.
TEST(Fuzz, WhatOnceFailedIsReadOrRefused) {
    const std::filesystem::path corpus = std::filesystem::path(ITEM3D_TEST_DATA) / "../fuzz/corpus";
    ASSERT_FALSE(fuzz::all_targets().empty());
    if (!std::filesystem::exists(corpus)) return;  // nothing failed yet
    for (const auto& folder : std::filesystem::directory_iterator(corpus)) {
        const std::string name = folder.path().filename().string();
        ASSERT_TRUE(fuzz::all_targets().contains(name)) << "no target is named " << name;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            SCOPED_TRACE(entry.path().string());
            const auto input = bytes_of(entry.path());
            EXPECT_EQ(fuzz::all_targets().at(name)(input.data(), input.size()), 0);
        }
    }
}

// Whole files of the tests, each truncated or with a byte changed at many places.
TEST(Fuzz, DamagedFilesAreReadOrRefused) {
    const std::filesystem::path data = ITEM3D_TEST_DATA;
    std::map<std::string, int> inputs;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(data)) {
        if (!entry.is_regular_file() || entry.file_size() > 20000) continue;
        const auto whole = bytes_of(entry.path());
        for (const std::string& name : targets_of(entry.path().extension().string())) {
            SCOPED_TRACE(name + " of " + entry.path().string());
            for (std::size_t part = 0; part < 16; ++part) {
                auto damaged = whole;
                const std::size_t place = whole.size() * part / 16;
                if (part % 2 == 0 && part > 0)
                    damaged.resize(place);
                else if (place < damaged.size() && part > 0)
                    damaged[place] ^= static_cast<std::uint8_t>(1u << part % 8);
                EXPECT_EQ(fuzz::all_targets().at(name)(damaged.data(), damaged.size()), 0);
                ++inputs[name];
            }
        }
    }
    for (const std::string name : {"gltf", "obj", "mtl", "png", "ktx2", "radiance", "openexr"})
        EXPECT_GE(inputs[name], 16) << name;
}

}  // namespace
}  // namespace item3d
