#include "item3d/edit/reconstructed_light.h"

#include "item3d/core/files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace item3d {
namespace {

TEST(ReconstructedLight, LiesBesideAReconstructedModelAlone) {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("item3d-reconstructed-light-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    const auto write = [&](const char* name) {
        write_atomically(folder / name, std::string_view("{}"));
    };
    write("model.glb");
    write("light.hdr");  // not proof enough: `item3d relight` writes such a file too
    EXPECT_TRUE(reconstructed_light(folder / "model.glb").empty());
    write("reconstruct.json");
    EXPECT_EQ(reconstructed_light(folder / "model.glb"), folder / "light.hdr");
    EXPECT_TRUE(reconstructed_light(folder / "other.glb").empty());
    std::filesystem::remove(folder / "light.hdr");
    EXPECT_TRUE(reconstructed_light(folder / "model.glb").empty());
    std::filesystem::remove_all(folder);
}

TEST(ReconstructedLight, IsNotForTexturesWhereThePriorNamesALight) {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("item3d-found-light-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    const nlohmann::json none = nlohmann::json::object();
    EXPECT_TRUE(suits_found_light(folder, none));  // there is no prior.json yet
    write_atomically(folder / "prior.json",
                     std::string_view(R"({"defaults": {"light": "studio"}})"));
    EXPECT_FALSE(suits_found_light(folder, none));
    EXPECT_TRUE(suits_found_light(folder, {{"optimize", "both"}}));
    EXPECT_TRUE(suits_found_light(folder, {{"optimize", "light"}}));
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace item3d
