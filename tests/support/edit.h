// Fixture of the edit tests: a small model and a request to edit it with a prior of random weights.
#pragma once

#include "item3d/edit/edit.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/lighting/environment.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>

namespace item3d::testing {

namespace fs = std::filesystem;

class EditTest : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() /
                  (std::string("item3d-edit-") +
                   ::testing::UnitTest::GetInstance()->current_test_info()->name() + "-" +
                   std::to_string(::getpid()));
        fs::create_directories(folder_);
        // With a fixed date, edits that are compared write the same bytes.
        setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
        write_cube(folder_ / "cube.glb");
        // The light is small, because loading the full-size preset takes a good part of a second.
        save_image(folder_ / "light.exr", make_light_preset("studio", 32));
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// Returns the mean absolute difference of the pixels, or infinity if the sizes differ.
    static double mean_difference(const Image& a, const Image& b) {
        if (a.pixels.empty() || a.pixels.size() != b.pixels.size())
            return std::numeric_limits<double>::infinity();
        double apart = 0;
        for (std::size_t i = 0; i < a.pixels.size(); ++i)
            apart += std::abs(a.pixels[i] - b.pixels[i]);
        return apart / static_cast<double>(a.pixels.size());
    }

    /// Writes a cube whose six sides have disjoint UVs in a checkered 64 x 64 texture.
    static void write_cube(const fs::path& path) {
        Model model;
        Primitive cube;
        for (int side = 0; side < 6; ++side) {
            const int axis = side / 2;
            const float sign = side % 2 == 0 ? 1.0f : -1.0f;
            for (int corner = 0; corner < 4; ++corner) {
                const float a = corner == 1 || corner == 2 ? 1.0f : -1.0f;
                const float b = corner >= 2 ? 1.0f : -1.0f;
                Vec3 position;
                position[axis] = sign;
                position[(axis + 1) % 3] = a * sign;
                position[(axis + 2) % 3] = b;
                Vec3 normal(0.0f);
                normal[axis] = sign;
                cube.positions.push_back(0.5f * position);
                cube.normals.push_back(normal);
                cube.uvs.emplace_back((static_cast<float>(side % 3) + 0.5f + 0.4f * a) / 3.0f,
                                      (static_cast<float>(side / 3) + 0.5f + 0.4f * b) / 2.0f);
            }
            const auto first = static_cast<std::uint32_t>(4 * side);
            for (const std::uint32_t index : {0u, 1u, 2u, 0u, 2u, 3u}) {
                cube.indices.push_back(first + index);
            }
        }
        model.primitives = {cube};
        Image image(64, 64, 3);
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                image.at(x, y, 0) = (x / 8 + y / 8) % 2 == 0 ? 0.8f : 0.2f;
                image.at(x, y, 1) = static_cast<float>(x) / 64.0f;
                image.at(x, y, 2) = 0.3f;
            }
        }
        model.textures.push_back({"checks", image, 8, Wrap::repeat, Wrap::repeat});
        Material material;
        material.name = "paint";
        material.base_color_texture = 0;
        material.metallic_factor = 0.0f;
        model.materials = {material};
        save_model(path, model);
    }

    /// Returns a request for a short edit. settings: settings that override those below.
    EditRequest request(const std::string& output, int iterations,
                        const nlohmann::json& settings = nlohmann::json::object()) const {
        EditRequest request;
        request.model = folder_ / "cube.glb";
        request.prior = fs::path(ITEM3D_TEST_DATA) / "models" / "pipeline_sd";
        request.output = folder_ / output;
        change(request, {{"from", "a red cube"},
                         {"to", "a blue cube"},
                         {"fit_steps", 30},
                         {"iterations", iterations},
                         {"batch", 1},
                         {"resolution", 32},
                         {"light", (folder_ / "light.exr").string()},
                         {"light_augment", "off"}});  // augmentation would take a second
        change(request, settings);
        request.precision = "fp32";
        request.image_pixels = 32;
        request.command = "item3d edit";
        return request;
    }

    /// Overrides settings of a request and plans it again.
    static void change(EditRequest& request, const nlohmann::json& settings) {
        nlohmann::json all = request.plan;
        all.update(settings);
        request.plan = EditPlan(all.get<EditSettings>());
    }

    Image base_color_of(const fs::path& path) const {
        const Model model = load_model(path);
        return model.textures.at(static_cast<std::size_t>(model.materials.at(0).base_color_texture))
            .image;
    }

    fs::path folder_;
};

}  // namespace item3d::testing
