// Tests of models far from their origin, such as maps in metres east and north of a datum.
#include "tests/support/io.h"

#include <fmt/format.h>

namespace item3d {
namespace {

using namespace testing_support;

constexpr glm::dvec3 place(436123.25, 5120456.75, 120.5);

void write_cube(const fs::path& path, double side, bool has_stray_vertex) {
    std::string text;
    for (int i = 0; i < 8; ++i) {
        text += "v";
        for (int c = 0; c < 3; ++c)
            text += fmt::format(" {:.6f}", place[c] + (i >> c & 1 ? 0.5 : -0.5) * side);
        text += "\n";
    }
    if (has_stray_vertex) text += "v 0 0 0\n";
    text += "s off\nf 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    write_quickly(path, Bytes(text.begin(), text.end()));
}

/// Checks that the model's box is the file's cube of this side.
void expect_cube(const Model& model, double side) {
    const auto box = model.bounds();
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(box[0][c] + model.origin[c], place[c] - 0.5 * side, 1e-6) << c;
        EXPECT_NEAR(box[1][c] + model.origin[c], place[c] + 0.5 * side, 1e-6) << c;
        EXPECT_LT(std::abs(box[1][c]), 2 * side);
        EXPECT_NEAR(box[1][c] - box[0][c], side, 1e-6 * side);
    }
    for (const Primitive& primitive : model.primitives)
        EXPECT_NEAR(signed_volume(primitive), side * side * side, 1e-5 * side * side * side);
}

TEST(FarAway, ObjPositionsAreReadInDoublePrecision) {
    const fs::path folder = fresh_folder("far_obj");
    for (const double side : {1.0, 0.1}) {
        for (const bool has_stray_vertex : {false, true}) {
            write_cube(folder / "a.obj", side, has_stray_vertex);
            expect_cube(load_model(folder / "a.obj"), side);
        }
    }
    // Models near the origin are not moved, so their results do not change.
    EXPECT_EQ(load_model(data_folder() / "nasty" / "no_uv_quads.obj").origin, glm::dvec3(0.0));
}

TEST(FarAway, IsWrittenWhereItWas) {
    const fs::path folder = fresh_folder("far_written");
    for (const double side : {1.0, 0.1}) {
        write_cube(folder / "a.obj", side, false);
        const Model model = load_model(folder / "a.obj");
        for (const char* name : {"b.obj", "b.glb", "b.gltf"}) {
            SCOPED_TRACE(name);
            save_model(folder / name, model);
            expect_cube(load_model(folder / name), side);
        }
        // The file itself has the positions, not only the model after loading.
        const std::string text = read_text(folder / "b.obj");
        double x = 0, y = 0, z = 0;
        ASSERT_EQ(std::sscanf(text.c_str() + text.find("\nv "), "\nv %lf %lf %lf", &x, &y, &z), 3);
        EXPECT_NEAR(x, place.x - 0.5 * side, 1e-6);
        EXPECT_NEAR(y, place.y - 0.5 * side, 1e-6);
        const auto json = read_gltf_file(folder / "b.gltf").json;
        EXPECT_NEAR(json["nodes"][0]["translation"][1].get<double>(), place.y, 2 * side);
        // A patched glTF keeps its position.
        save_model(folder / "c.glb", load_model(folder / "b.glb"));
        expect_cube(load_model(folder / "c.glb"), side);
    }
}

TEST(FarAway, PositionsThatFloatsCannotHoldAreSaid) {
    const fs::path folder = fresh_folder("far_floats");
    GltfFile file = read_gltf_file(data_folder() / "gltf" / "sparse.gltf");
    // The triangle's positions are so large that neighbouring floats are half a metre apart.
    const float floats[] = {436123.0f, 5120456.0f, 0.0f,       436124.0f, 5120456.0f,
                            0.0f,      436123.0f,  5120457.0f, 0.0f};
    const auto* raw = reinterpret_cast<const std::uint8_t*>(floats);
    write_quickly(folder / "a.bin", Bytes(raw, raw + sizeof floats));
    const nlohmann::json json = {
        {"asset", {{"version", "2.0"}}},
        {"scenes", {{{"nodes", {0}}}}},
        {"nodes", {{{"mesh", 0}}}},
        {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
        {"accessors",
         {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}}},
        {"bufferViews", {{{"buffer", 0}, {"byteLength", 36}}}},
        {"buffers", {{{"uri", "a.bin"}, {"byteLength", 36}}}}};
    write_atomically(folder / "a.gltf", std::string_view(json.dump()));
    testing::internal::CaptureStderr();
    const Model model = load_model(folder / "a.gltf");
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("so far from its origin"), std::string::npos) << said;
    EXPECT_NE(model.origin, glm::dvec3(0.0));
    EXPECT_EQ(said.find("warning"), said.rfind("warning")) << said;  // only one warning
    EXPECT_NEAR(model.bounds()[1].x - model.bounds()[0].x, 1.0f, 1e-6f);
}

}  // namespace
}  // namespace item3d
