// Tests of the spellings of file names in models.
#include "item3d/core/error.h"
#include "item3d/io/texture_format.h"
#include "tests/support/textured.h"

namespace item3d {
namespace {

using namespace testing_support;

class FileAddresses : public testing::Test {
  protected:
    /// Writes a glTF into a new folder and an image under `name`. Returns true if the glTF, which
    /// calls the image `uri`, finds it. said_ then has the messages.
    bool finds(const std::string& uri, const fs::path& name) {
        const fs::path folder = fresh_folder("addresses");
        fs::create_directories((folder / name).parent_path());
        write_textured(folder / "a.gltf", {}, {{{"source", 0}}}, textured_materials(1),
                       {{"images", {{{"uri", uri}}}}});
        write_quickly(folder / name, image_);
        testing::internal::CaptureStderr();
        const Model model = load_model(folder / "a.gltf");
        said_ = testing::internal::GetCapturedStderr();
        return model.materials[0].base_color_texture >= 0;
    }
    bool obj_finds(const std::string& address, const fs::path& name) {
        const fs::path folder = fresh_folder("obj_addresses");
        fs::create_directories((folder / name).parent_path());
        write_quickly(folder / name, image_);
        write_atomically(folder / "a.mtl", std::string_view("newmtl a\nmap_Kd " + address + "\n"));
        write_atomically(folder / "a.obj",
                         std::string_view("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 "
                                          "0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n"));
        return load_model(folder / "a.obj").materials[0].base_color_texture >= 0;
    }

    Bytes image_ = encode_texture(test_image(3), {}, 8);
    std::string said_;
};

TEST_F(FileAddresses, AreForgivenWithANote) {
    EXPECT_TRUE(finds("t.png", "t.png"));
    EXPECT_EQ(said_, "");
    EXPECT_TRUE(finds("a%20b.png", "a b.png"));
    EXPECT_EQ(said_, "");
    const std::pair<const char*, const char*> spellings[] = {
        {"maps%5Ct.png", "maps/t.png"},
        {"maps\\t.png", "maps/t.png"},
        {"T.PNG", "t.png"},
        {"Maps/T.png", "maps/t.png"},
        {"caf%C3%A9.png", "cafe\xcc\x81.png"},
        {"cafe%CC%81.png", "caf\xc3\xa9.png"},
        {"CAF%C3%89.png", "caf\xc3\xa9.png"},
        {"t.png?v=3", "t.png"},
        {"t.png#layer", "t.png"},
        {"a%2520b.png", "a b.png"},
        {"a%20b.png", "a%20b.png"},
        {"100%.png", "100%.png"},
        {"./maps//t.png", "maps/t.png"},
        {"C:\\Users\\me\\t.png", "t.png"},
        {"file:///home/me/t.png", "t.png"},
        {"/home/me/T.png", "t.png"},
        {"../shared/t.png", "t.png"},
    };
    for (const auto& [uri, name] : spellings) {
        EXPECT_TRUE(finds(uri, name)) << uri << ": " << said_;
        const bool is_plain = std::string(uri) == name || std::string(uri).starts_with("./");
        EXPECT_TRUE(is_plain || said_.find("read as") != std::string::npos) << uri << said_;
    }
    EXPECT_TRUE(finds("a?b.png", "a?b.png"));
}

TEST_F(FileAddresses, OfMaterialLibrariesToo) {
    EXPECT_TRUE(obj_finds("maps\\T.png", "maps/t.png"));
    EXPECT_TRUE(obj_finds("C:\\work\\maps\\t.png", "t.png"));
    EXPECT_TRUE(obj_finds("caf\xe9.png", "caf\xc3\xa9.png"));
    EXPECT_TRUE(obj_finds("a%20b.png", "a b.png"));
}

TEST_F(FileAddresses, NeverLeadOutOfTheFolder) {
    const fs::path folder = fresh_folder("addresses_outside");
    fs::create_directories(folder / "inner");
    write_quickly(folder / "secret.png", image_);
    fs::create_symlink(folder / "secret.png", folder / "inner" / "Link.png");
    for (const char* uri :
         {"../secret.png", "..\\secret.png", "%2e%2e%5csecret.png", "link.png", "Link.png",
          "inner/../../secret.png", "http://example.org/secret.png"}) {
        write_textured(folder / "inner" / "a.gltf", {}, {{{"source", 0}}}, textured_materials(1),
                       {{"images", {{{"uri", uri}}}}});
        EXPECT_EQ(load_model(folder / "inner" / "a.gltf").materials[0].base_color_texture, -1)
            << uri;
    }
}

TEST_F(FileAddresses, AreWrittenAsTheFilesAreCalled) {
    const fs::path folder = fresh_folder("addresses_copy");
    fs::create_directories(folder / "maps");
    fs::create_directories(folder / "copy");
    write_quickly(folder / "maps" / "t.png", image_);
    write_textured(folder / "a.gltf", {}, {{{"source", 0}}}, textured_materials(1),
                   {{"images", {{{"uri", "Maps%5CT.png?x"}}}}});
    save_model(folder / "copy" / "b.gltf", load_model(folder / "a.gltf"));
    EXPECT_EQ(read_gltf_file(folder / "copy" / "b.gltf").json["images"][0]["uri"], "maps/t.png");
    EXPECT_EQ(read_bytes(folder / "copy" / "maps" / "t.png"), image_);
}

TEST(LfsPointers, AreNamed) {
    const fs::path folder = fresh_folder("lfs");
    const std::string_view pointer =
        "version https://git-lfs.github.com/spec/v1\noid sha256:0123\nsize 12345\n";
    for (const char* name : {"m.glb", "m.gltf", "m.obj", "t.png"}) {
        write_atomically(folder / name, pointer);
        try {
            if (std::string(name) == "t.png") {
                load_image(folder / name);
            } else {
                load_model(folder / name);
            }
            ADD_FAILURE() << name;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("git lfs pull"), std::string::npos)
                << error.what();
        }
    }
}

}  // namespace
}  // namespace item3d
