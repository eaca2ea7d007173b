// Tests of damaged Draco and meshopt data, which must be refused with an error or read as valid.
#include "item3d/core/error.h"
#include "item3d/io/gltf/read.h"
#include "tests/support/io.h"

#include <functional>

namespace item3d {
namespace {

using namespace testing_support;
using OrderedJson = nlohmann::ordered_json;

struct Damage {
    const char* message;  ///< part of the error
    std::function<void(GltfFile&)> make;
};

void expect_refused(const std::string& name, const std::vector<Damage>& damages) {
    const fs::path folder = fresh_folder("damaged");
    for (const Damage& damage : damages) {
        SCOPED_TRACE(damage.message);
        GltfFile file = read_gltf_file(fixture(name));
        damage.make(file);
        file.json["buffers"][0]["uri"] = "data.bin";
        write_atomically(folder / "data.bin", std::span<const std::uint8_t>(file.binary));
        write_atomically(folder / "damaged.gltf", std::string_view(file.json.dump()));
        try {
            load_model(folder / "damaged.gltf");
            ADD_FAILURE() << "was accepted";
        } catch (const InputError& error) {
            const std::string what = error.what();
            EXPECT_NE(what.find("damaged.gltf"), std::string::npos) << what;
            EXPECT_NE(what.find(damage.message), std::string::npos) << what;
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        }
    }
}

TEST(Draco, DamagedFilesAreRefused) {
    const auto primitive = [](GltfFile& file) -> OrderedJson& {
        return file.json["meshes"][0]["primitives"][0];
    };
    const auto extension = [=](GltfFile& file) -> OrderedJson& {
        return primitive(file)["extensions"][draco_extension];
    };
    const auto accessor = [=](GltfFile& file, const char* name) -> OrderedJson& {
        return file.json["accessors"][primitive(file)["attributes"][name].get<std::size_t>()];
    };
    const auto stream = [](GltfFile& file) {
        return file.json["bufferViews"][3]["byteOffset"].get<std::size_t>();
    };
    expect_refused(
        "draco_edgebreaker.glb",
        {{"attribute 99", [&](GltfFile& f) { extension(f)["attributes"]["NORMAL"] = 99; }},
         {"3 numbers", [&](GltfFile& f) { extension(f)["attributes"]["TEXCOORD_0"] = 1; }},
         {"its accessor has 151 VEC2",
          [&](GltfFile& f) { accessor(f, "NORMAL")["type"] = "VEC2"; }},
         {"its accessor has 150 VEC3", [&](GltfFile& f) { accessor(f, "NORMAL")["count"] = 150; }},
         {"the accessors 152", [&](GltfFile& f) { accessor(f, "POSITION")["count"] = 152; }},
         {"as 100 vertices", [&](GltfFile& f) { accessor(f, "POSITION")["count"] = 100; }},
         {"more than", [&](GltfFile& f) { accessor(f, "POSITION")["count"] = 2000000000; }},
         {"more than the compressed",
          [&](GltfFile& f) { f.json["accessors"][0]["count"] = 2000000001; }},
         {"and 10 triangles", [&](GltfFile& f) { f.json["accessors"][0]["count"] = 30; }},
         {"unsigned integers",
          [&](GltfFile& f) { f.json["accessors"][0]["componentType"] = 5126; }},
         {"cannot be read as described by its accessor",
          [&](GltfFile& f) { accessor(f, "NORMAL")["componentType"] = 5121; }},
         {"indices is missing", [&](GltfFile& f) { primitive(f).erase("indices"); }},
         {"mode 4", [&](GltfFile& f) { primitive(f)["mode"] = 5; }},
         {"bufferView is 77", [&](GltfFile& f) { extension(f)["bufferView"] = 77; }},
         {"bufferView is missing", [&](GltfFile& f) { extension(f).erase("bufferView"); }},
         {"attributes are missing", [&](GltfFile& f) { extension(f).erase("attributes"); }},
         {"POSITION is not among",
          [&](GltfFile& f) { extension(f)["attributes"].erase("POSITION"); }},
         {"COLOR_0 is missing", [&](GltfFile& f) { extension(f)["attributes"]["COLOR_0"] = 0; }},
         {"used by other Draco data",
          [&](GltfFile& f) { primitive(f)["attributes"]["NORMAL"] = 1; }},
         {"cannot be read as 151",
          [&](GltfFile& f) { f.json["bufferViews"][3]["byteLength"] = 700; }},
         {"cannot be read as 151",
          [&](GltfFile& f) { f.json["bufferViews"][3]["byteLength"] = 0; }},
         {"cannot be read as 151", [&](GltfFile& f) { f.binary[stream(f)] = 'X'; }},
         {"version 2.2", [&](GltfFile& f) { f.binary[stream(f) + 6] = 1; }},
         {"version 2.2", [&](GltfFile& f) { f.binary[stream(f) + 7] = 0; }}});
}

TEST(Meshopt, DamagedFilesAreRefused) {
    const auto extension = [](GltfFile& file, int view) -> OrderedJson& {
        return file.json["bufferViews"][view]["extensions"][meshopt_extension];
    };
    // Buffer view 3 has indices, 4 octahedral normals, 5 positions.
    expect_refused(
        "meshopt_filters.glb",
        {{"must be ATTRIBUTES", [&](GltfFile& f) { extension(f, 5)["mode"] = "VERTICES"; }},
         {"found 151 elements of 8 bytes, mode ,",
          [&](GltfFile& f) { extension(f, 5).erase("mode"); }},
         {"filter must be", [&](GltfFile& f) { extension(f, 4)["filter"] = "COLOR"; }},
         {"cannot have a filter", [&](GltfFile& f) { extension(f, 3)["filter"] = "EXPONENTIAL"; }},
         {"8 bytes", [&](GltfFile& f) { extension(f, 4)["filter"] = "QUATERNION"; }},
         {"4 or 8 bytes",
          [&](GltfFile& f) {
              extension(f, 4)["byteStride"] = 12;
              extension(f, 4)["count"] = 50;
          }},
         {"multiple of 4", [&](GltfFile& f) { extension(f, 5)["byteStride"] = 6; }},
         {"multiple of 4", [&](GltfFile& f) { extension(f, 5)["byteStride"] = 0; }},
         {"multiple of 4", [&](GltfFile& f) { extension(f, 5)["byteStride"] = 260; }},
         {"2 or 4 bytes", [&](GltfFile& f) { extension(f, 3)["byteStride"] = 8; }},
         {"a multiple of 3", [&](GltfFile& f) { extension(f, 3)["count"] = 671; }},
         {"byteLength is 1208", [&](GltfFile& f) { extension(f, 5)["count"] = 150; }},
         {"byteStride must be 8",
          [&](GltfFile& f) { f.json["bufferViews"][5]["byteStride"] = 12; }},
         {"elements at most",
          [&](GltfFile& f) {
              extension(f, 5)["count"] = 1000000000;
              f.json["bufferViews"][5]["byteLength"] = 8000000000;
          }},
         {"cannot be decompressed",
          [&](GltfFile& f) {
              extension(f, 5)["count"] = 1510;
              f.json["bufferViews"][5]["byteLength"] = 12080;
          }},
         {"cannot be decompressed", [&](GltfFile& f) { extension(f, 5)["byteLength"] = 600; }},
         {"cannot be decompressed", [&](GltfFile& f) { extension(f, 3)["byteOffset"] = 300; }},
         {"exceed buffer 0", [&](GltfFile& f) { extension(f, 5)["byteOffset"] = 2000; }},
         {"exceed buffer 1", [&](GltfFile& f) { extension(f, 5)["buffer"] = 1; }},
         {"buffer is 9", [&](GltfFile& f) { extension(f, 5)["buffer"] = 9; }},
         {"count is missing", [&](GltfFile& f) { extension(f, 5).erase("count"); }},
         {"too large for the file", [&](GltfFile& f) {
              const OrderedJson view = f.json["bufferViews"][5];
              for (int i = 0; i < 1000; ++i)
                  f.json["bufferViews"].push_back(view);
          }}});
}

// Each byte of the compressed data is changed in turn. The file must be refused or read as valid,
// and never give extreme values.
TEST(Compressed, TurnedBytesNeverCrash) {
    // Each file has the offset of its geometry, which follows its images.
    const std::vector<std::pair<const char*, std::size_t>> files = {{"draco_edgebreaker.glb", 296},
                                                                    {"draco_sequential.glb", 0},
                                                                    {"meshopt_filters.glb", 296},
                                                                    {"meshopt_morph_skin.glb", 0}};
    for (const auto& [name, begin] : files) {
        const Bytes whole = read_bytes(fixture(name));
        const std::size_t binary = read_gltf_file(fixture(name)).binary.size();
        int refused = 0, accepted = 0;
        for (std::size_t i = whole.size() - binary + begin; i < whole.size(); ++i) {
            SCOPED_TRACE(std::string(name) + " byte " + std::to_string(i));
            Bytes bytes = whole;
            const int masks[] = {0xff, 0x01, 0x80};
            bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ masks[i % 3]);
            try {
                expect_sound(read_gltf(name, bytes, {}));
                ++accepted;
            } catch (const InputError&) {
                ++refused;
            }
        }
        EXPECT_GT(refused, 20) << name;
        EXPECT_GT(accepted, 20) << name;
    }
}

}  // namespace
}  // namespace item3d
