// Tests of malformed files: each gives an error that names the file, and never a crash.
#include "item3d/core/error.h"
#include "tests/support/io.h"

namespace item3d {
namespace {

using namespace testing_support;

// Returns true if the file was refused.
bool is_refused(const fs::path& path, const std::string& family) {
    try {
        if (family == "png" || family == "hdr" || family == "exr" || family == "jpg") {
            const Image image = load_image(path);
            for (const float value : image.pixels)
                EXPECT_TRUE(std::isfinite(value));
        } else {
            expect_sound(load_model(path));
        }
        return false;
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find(path.filename().string()), std::string::npos)
            << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        return true;
    }
}

void run_folder(const fs::path& folder) {
    int count = 0;
    const nlohmann::json manifest = read_manifest(folder);
    for (const auto& [name, entry] : manifest.items()) {
        const std::string family = entry["family"];
        if (family == "safetensors" || family == "dataset") continue;
        SCOPED_TRACE(name + ": " + entry["problem"].get<std::string>());
        const bool refused = is_refused(folder / name, family);
        if (entry["expect"] == "reject") {
            EXPECT_TRUE(refused);
        }
        ++count;
    }
    EXPECT_GE(count, 20);
}

TEST(BadFiles, AreRefusedOrLoadWithDefaults) {
    run_folder(data_folder() / "bad");
    const fs::path more = reference_data::whole() / "bad";
    if (fs::exists(more)) run_folder(more);
}

TEST(BadFiles, MissingOnesAreNamed) {
    EXPECT_THROW(load_model("/nowhere/x.glb"), InputError);
    EXPECT_THROW(load_model(data_folder()), InputError);
    EXPECT_THROW(load_image("/nowhere/x.png"), InputError);
    EXPECT_THROW(load_image(data_folder() / "bad" / "empty.obj"), InputError);
}

// Every file is cut off at many places and has bytes flipped. It must be refused or read as valid.
TEST(BadFiles, CutAndTurnedBytesNeverCrash) {
    const fs::path folder = fresh_folder("cut");
    const std::vector<std::string> names = {"gltf/quantized.glb",
                                            "gltf/sparse.gltf",
                                            "gltf/morph_skin.glb",
                                            "gltf/draco_edgebreaker.glb",
                                            "gltf/draco_sequential.glb",
                                            "gltf/meshopt_filters.glb",
                                            "gltf/full_pbr.glb",
                                            "nasty/multi_material.obj",
                                            "nasty/mixed_uv.obj",
                                            "images/adam7.png",
                                            "images/palette_trns.png",
                                            "images/progressive_420.jpg",
                                            "images/rle.hdr",
                                            "images/half_piz.exr",
                                            "images/float_zips.exr"};
    std::uint32_t random = 12345;
    const auto next = [&](std::size_t limit) {
        random = random * 1664525u + 1013904223u;
        return static_cast<std::size_t>(random >> 8) % limit;
    };
    for (const std::string& name : names) {
        const Bytes whole = read_bytes(data_folder() / name);
        const fs::path path = folder / fs::path(name).filename();
        const std::string family =
            name.starts_with("images") ? path.extension().string().substr(1) : "";
        for (int i = 0; i < 40; ++i) {
            Bytes bytes = whole;
            if (i % 2 == 0) {
                bytes.resize(next(bytes.size()));
            } else {
                for (int k = 0; k < 3; ++k)
                    bytes[next(bytes.size())] = static_cast<std::uint8_t>(next(256));
            }
            write_quickly(path, bytes);
            SCOPED_TRACE(name + " " + std::to_string(i));
            try {
                if (family.empty()) {
                    expect_sound(load_model(path));
                } else {
                    load_image(path);
                }
            } catch (const Error&) {
            }
        }
    }
}

TEST(BadFiles, NeverLeaveTheirFolder) {
    const fs::path folder = fresh_folder("outside");
    fs::create_directories(folder / "inner");
    const std::string cube = read_text(data_folder() / "bad" / "two_corner_face.obj");
    write_atomically(folder / "secret.mtl", std::string_view("newmtl a\nKd 1 0 0\n"));
    fs::create_symlink(folder / "secret.mtl", folder / "inner" / "link.mtl");
    const std::vector<std::string> libraries = {"../secret.mtl", (folder / "secret.mtl").string(),
                                                "link.mtl"};
    for (const std::string& library : libraries) {
        write_atomically(folder / "inner" / "a.obj",
                         std::string_view("mtllib " + library + "\nusemtl a\n" + cube));
        const Model model = load_model(folder / "inner" / "a.obj");
        EXPECT_EQ(model.materials[0].base_color_factor, Vec4(0.8f, 0.8f, 0.8f, 1.0f)) << library;
    }
    for (const std::string uri : {"http://example.org/a.bin", "file:///etc/passwd", "//host/a.bin",
                                  "%2e%2e/secret.mtl", "/etc/passwd"}) {
        write_atomically(
            folder / "inner" / "a.gltf",
            std::string_view("{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"" + uri +
                             "\",\"byteLength\":4}]}"));
        try {
            load_model(folder / "inner" / "a.gltf");
            ADD_FAILURE() << uri;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("refers to"), std::string::npos)
                << error.what();
        }
    }
}

TEST(BadFiles, ManyNodesOfOneMeshAreBounded) {
    const fs::path folder = fresh_folder("bounded");
    auto file = read_gltf_file(data_folder() / "gltf" / "sparse.gltf");
    // The accessor has no data, so it stands for zeros: a hundred times 65536 vertices in a file of
    // a few hundred bytes.
    file.json["accessors"][0] = {{"componentType", 5126}, {"count", 65536}, {"type", "VEC3"}};
    file.json["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", 0}}}};
    for (int i = 0; i < 100; ++i) {
        file.json["scenes"][0]["nodes"].push_back(file.json["nodes"].size());
        file.json["nodes"].push_back({{"mesh", 0}});
    }
    write_atomically(folder / "a.gltf", std::string_view(file.json.dump()));
    EXPECT_THROW(load_model(folder / "a.gltf"), InputError);
    file.json["accessors"][0]["count"] = 100000000;
    write_atomically(folder / "a.gltf", std::string_view(file.json.dump()));
    EXPECT_THROW(load_model(folder / "a.gltf"), InputError);
}

// The attribute claims two gigabytes, which the OpenEXR library would allocate.
TEST(BadFiles, OpenExrAttributesMustFitTheFile) {
    const fs::path folder = fresh_folder("attributes");
    Bytes bytes = read_bytes(data_folder() / "images" / "float_zips.exr");
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t at = text.find(std::string_view("type\0string\0", 12));
    ASSERT_NE(at, std::string_view::npos);
    bytes[at + 12 + 3] = 0x7f;
    write_atomically(folder / "a.exr", std::span<const std::uint8_t>(bytes));
    try {
        load_image(folder / "a.exr");
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("header"), std::string::npos) << error.what();
    }
}

TEST(BadFiles, DeepJsonIsRefused) {
    const fs::path folder = fresh_folder("deep");
    const std::string deep =
        "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(100000, '[') +
        std::string(100000, ']') + "}";
    write_atomically(folder / "a.gltf", std::string_view(deep));
    EXPECT_THROW(load_model(folder / "a.gltf"), InputError);
}

}  // namespace
}  // namespace item3d
