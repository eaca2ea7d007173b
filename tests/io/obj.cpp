// Tests of real-world OBJ and MTL files: names, encodings, comments, and warnings about flaws.
#include "item3d/core/error.h"
#include "tests/support/io.h"

namespace item3d {
namespace {

using namespace testing_support;

// Returns a cube of side `side` around `centre`, with texture coordinates.
std::string cube_text(glm::dvec3 centre = glm::dvec3(0.0), double side = 1.0,
                      const std::string& before_faces = "") {
    std::string text;
    for (int i = 0; i < 8; ++i) {
        text += "v";
        for (int c = 0; c < 3; ++c) {
            char word[64];
            std::snprintf(word, sizeof word, " %.6f", centre[c] + (i >> c & 1 ? 0.5 : -0.5) * side);
            text += word;
        }
        text += "\n";
    }
    text += "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + before_faces;
    return text +
           "f 1/1 3/2 4/3 2/4\nf 5/1 6/2 8/3 7/4\nf 1/1 2/2 6/3 5/4\nf 3/1 7/2 8/3 4/4\n"
           "f 1/1 5/2 7/3 3/4\nf 2/1 4/2 8/3 6/4\n";
}

void put(const fs::path& path, const std::string& text) {
    fs::create_directories(path.parent_path());
    write_quickly(path, Bytes(text.begin(), text.end()));
}

void put_red(const fs::path& path) {
    fs::create_directories(path.parent_path());
    Image red(4, 4, 3);
    for (std::size_t i = 0; i < red.pixels.size(); i += 3)
        red.pixels[i] = 1.0f;
    save_image(path, red);
}

/// A loaded model, and what loading wrote to stderr.
struct Loaded {
    Model model;
    std::string said;
    bool says(const std::string& words) const { return said.find(words) != std::string::npos; }
    bool is_red() const {
        const int texture = model.materials.at(0).base_color_texture;
        if (texture < 0) return false;
        const Image& image = model.textures.at(static_cast<std::size_t>(texture)).image;
        return image.at(1, 1, 0) == 1.0f && image.at(1, 1, 1) == 0.0f;
    }
};

Loaded load_and_listen(const fs::path& path) {
    testing::internal::CaptureStderr();
    Loaded loaded;
    try {
        loaded.model = load_model(path);
    } catch (...) {
        testing::internal::GetCapturedStderr();
        throw;
    }
    loaded.said = testing::internal::GetCapturedStderr();
    expect_sound(loaded.model);
    return loaded;
}

const std::string red_mtl = "newmtl a\nKd 1 1 1\nmap_Kd t.png\n";

TEST(Obj, LibrariesInFoldersFindTheirTextures) {
    for (const std::string name : {"mat/m.mtl", "mat\\m.mtl"}) {
        SCOPED_TRACE(name);
        const fs::path folder = fresh_folder("obj_subfolder");
        put(folder / "q.obj", "mtllib " + name + "\n" + cube_text({}, 1, "usemtl a\n"));
        put(folder / "mat/m.mtl", red_mtl);
        put_red(folder / "mat/t.png");
        EXPECT_TRUE(load_and_listen(folder / "q.obj").is_red());
        // The texture may also lie beside the model, or in a folder beside the library's folder.
        fs::rename(folder / "mat/t.png", folder / "t.png");
        EXPECT_TRUE(load_and_listen(folder / "q.obj").is_red());
        fs::create_directories(folder / "tex");
        fs::rename(folder / "t.png", folder / "tex/t.png");
        put(folder / "mat/m.mtl", "newmtl a\nmap_Kd ..\\tex\\t.png\n");
        EXPECT_TRUE(load_and_listen(folder / "q.obj").is_red());
        // A texture outside of the model's folder is never used.
        put(folder / "mat/m.mtl", "newmtl a\nmap_Kd ../../obj_outside.png\n");
        put_red(folder.parent_path() / "obj_outside.png");
        const Loaded outside = load_and_listen(folder / "q.obj");
        EXPECT_FALSE(outside.is_red());
        EXPECT_TRUE(outside.says("outside")) << outside.said;
        EXPECT_EQ(outside.model.materials[0].missing_base_color, "../../obj_outside.png");
    }
}

TEST(Obj, TexturesElsewhereAreReadFromFoldersThatAreAllowed) {
    const fs::path folder = fresh_folder("obj_allowed");
    put(folder / "model/q.obj", "mtllib m.mtl\n" + cube_text({}, 1, "usemtl a\n"));
    put_red(folder / "shared/t.png");
    const LoadOptions options{.texture_folders = {folder / "shared"}};
    for (const std::string name : {"../shared/t.png", "C:\\work\\t.png", "t.png"}) {
        put(folder / "model/m.mtl", "newmtl a\nmap_Kd " + name + "\n");
        EXPECT_EQ(load_model(folder / "model/q.obj").materials[0].base_color_texture, -1) << name;
        EXPECT_EQ(load_model(folder / "model/q.obj", options).materials[0].base_color_texture, 0)
            << name;
    }
    fs::create_symlink(folder / "secret.png", folder / "shared/link.png");
    put_red(folder / "secret.png");
    put(folder / "model/m.mtl", "newmtl a\nmap_Kd ../shared/link.png\n");
    EXPECT_EQ(load_model(folder / "model/q.obj", options).materials[0].base_color_texture, -1);
}

TEST(Obj, RemarksAndOptionsBehindNamesAreLeftOut) {
    const fs::path folder = fresh_folder("obj_remarks");
    put_red(folder / "t.png");
    put(folder / "m.mtl", red_mtl);
    put(folder / "q.obj",
        "mtllib m.mtl # the materials\n" + cube_text({}, 1, "usemtl a # paint\n"));
    Loaded loaded = load_and_listen(folder / "q.obj");
    EXPECT_TRUE(loaded.is_red());
    EXPECT_EQ(loaded.model.materials[0].name, "a");
    EXPECT_EQ(loaded.said, "");
    for (const std::string behind : {" # red", " -imfchan b", " -s 2 2 1 -clamp on # both"}) {
        put(folder / "m.mtl", "newmtl a # paint\nmap_Kd t.png" + behind + "\n");
        loaded = load_and_listen(folder / "q.obj");
        EXPECT_TRUE(loaded.is_red()) << behind;
    }
    EXPECT_EQ(loaded.model.textures[0].wrap_u, Wrap::clamp_to_edge);
    EXPECT_EQ(loaded.model.primitives[0].uvs[1].x, 2.0f);
    // Names may contain "#", as 3ds Max numbers its materials.
    put_red(folder / "a #1.png");
    put(folder / "m.mtl", "newmtl Material #1\nmap_Kd a #1.png\nnewmtl Material #2\nKd 0 1 0\n");
    put(folder / "q.obj", "mtllib m.mtl\n" + cube_text({}, 1, "usemtl Material #1\n"));
    EXPECT_TRUE(load_and_listen(folder / "q.obj").is_red());
    put(folder / "q.obj", "mtllib m.mtl\n" + cube_text({}, 1, "usemtl Material #2\n"));
    EXPECT_EQ(load_model(folder / "q.obj").materials[0].base_color_factor, Vec4(0, 1, 0, 1));
}

TEST(Obj, ALibraryOfTheModelsNameStandsInForOneThatIsMissing) {
    const fs::path folder = fresh_folder("obj_own_name");
    put_red(folder / "t.png");
    put(folder / "q.mtl", red_mtl);
    put(folder / "q.obj", "mtllib Old Name.mtl\n" + cube_text({}, 1, "usemtl a\n"));
    const Loaded loaded = load_and_listen(folder / "q.obj");
    EXPECT_TRUE(loaded.is_red());
    EXPECT_TRUE(loaded.says("Old Name.mtl") && loaded.says("'q.mtl' is used instead"))
        << loaded.said;
    put(folder / "q.obj", cube_text({}, 1, "usemtl a\n"));
    EXPECT_TRUE(load_and_listen(folder / "q.obj").is_red());
}

TEST(Obj, MaterialsThatNothingDefinesAreNamed) {
    const fs::path folder = fresh_folder("obj_unknown");
    put(folder / "q.obj", cube_text({}, 1, "usemtl wood\n"));
    const Loaded loaded = load_and_listen(folder / "q.obj");
    EXPECT_TRUE(loaded.says("no material library defines 'wood'; rendered in grey")) << loaded.said;
    put(folder / "q.obj", cube_text());
    EXPECT_EQ(load_and_listen(folder / "q.obj").said, "");
    put(folder / "q.obj", "mtllib m.mtl\n" + cube_text({}, 1, "usemtl Wood\n"));
    put(folder / "m.mtl", "newmtl wood\nKd 1 0 0\n");
    EXPECT_EQ(load_and_listen(folder / "q.obj").model.materials[0].base_color_factor.y, 0.0f);
}

TEST(Obj, OldEncodingsAreToldByTheFilesThatAreThere) {
    struct Case {
        std::string name, written;
    };
    const std::vector<Case> cases{{"\xe7\xba\xa2\xe8\x89\xb2", "\xba\xec\xc9\xab"},  // GBK
                                  {"gr\xc3\xbcn", "gr\xfcn"},                        // Latin-1
                                  // Shift_JIS, where a backslash is the second byte of a character.
                                  {"\xe8\xa1\xa8\xe6\xa8\xa1", "\x95\x5c\x96\xcd"},
                                  // Decomposed, as macOS names files; the library composes it.
                                  {"cafe\xcc\x81", "caf\xe9"}};
    for (const Case& c : cases) {
        const fs::path folder = fresh_folder("obj_encoding");
        put_red(folder / "t.png");
        put(folder / (c.name + ".mtl"), red_mtl);
        put(folder / "q.obj", "mtllib " + c.written + ".mtl\n" + cube_text({}, 1, "usemtl a\n"));
        if (c.name.find('\xcc') == std::string::npos) {
            EXPECT_TRUE(load_and_listen(folder / "q.obj").is_red()) << c.name;
        }
        put(folder / "m.mtl", "newmtl " + c.written + "\nmap_Kd " + c.written + ".png\n");
        put_red(folder / (c.name + ".png"));
        put(folder / "q.obj", "mtllib m.mtl\n" + cube_text({}, 1, "usemtl " + c.name + "\n"));
        const Loaded loaded = load_and_listen(folder / "q.obj");
        if (c.name.find('\xcc') == std::string::npos) {
            EXPECT_TRUE(loaded.is_red()) << c.name << loaded.said;
            EXPECT_EQ(loaded.model.materials[0].name, c.name);
        }
        EXPECT_TRUE(loaded.says("is not UTF-8; read as")) << loaded.said;
    }
    // The name on disk has the same bytes as in the file, as an old program unpacks it.
    const fs::path folder = fresh_folder("obj_raw_name");
    put(folder / "q.obj", "mtllib m.mtl\n" + cube_text({}, 1, "usemtl a\n"));
    put(folder / "m.mtl", "newmtl a\nmap_Kd \xba\xec\xc9\xab.png\n");
    put_red(folder / "\xba\xec\xc9\xab.png");
    EXPECT_TRUE(load_and_listen(folder / "q.obj").is_red());
}

TEST(Obj, OldEncodingsInRemarksDoNotMatter) {
    const fs::path folder = fresh_folder("obj_old_remark");
    put(folder / "m.mtl", red_mtl);
    put_red(folder / "t.png");
    put(folder / "q.obj", "# gr\xfcn\nmtllib m.mtl\n" + cube_text({}, 1, "usemtl a\n"));
    const Loaded loaded = load_and_listen(folder / "q.obj");
    EXPECT_TRUE(loaded.is_red());
    EXPECT_EQ(loaded.said, "");
}

TEST(Obj, Utf16IsRead) {
    const auto wide = [](const std::string& text, bool is_little, bool has_mark) {
        std::string result = has_mark ? (is_little ? "\xff\xfe" : "\xfe\xff") : "";
        for (const char c : text) {
            if (!is_little) result.push_back('\0');
            result.push_back(c);
            if (is_little) result.push_back('\0');
        }
        return result;
    };
    for (const bool is_little : {true, false}) {
        for (const bool has_mark : {true, false}) {
            const fs::path folder = fresh_folder("obj_utf16");
            put_red(folder / "t.png");
            put(folder / "m.mtl", wide(red_mtl, is_little, has_mark));
            put(folder / "q.obj",
                wide("mtllib m.mtl\n" + cube_text({}, 1, "usemtl a\n"), is_little, has_mark));
            EXPECT_TRUE(load_and_listen(folder / "q.obj").is_red());
        }
    }
    const fs::path folder = fresh_folder("obj_half_utf16");
    put(folder / "q.obj", "\xff\xfe" + std::string(9, 'a'));
    EXPECT_THROW(load_model(folder / "q.obj"), InputError);
}

TEST(Obj, WhatIsNoNumberIsSaidWithItsLine) {
    const fs::path folder = fresh_folder("obj_nan");
    std::string text = cube_text();
    const auto replace = [&](const std::string& from, const std::string& to) {
        text.replace(text.find(from), from.size(), to);
    };
    replace("vt 1 0\n", "vt nan 0\n");
    replace("vt 1 1\n", "vt 0.5 -nan(ind)\n");
    put(folder / "q.obj", text);
    const Loaded loaded = load_and_listen(folder / "q.obj");
    EXPECT_TRUE(
        loaded.says("q.obj:10: a texture coordinate is not a finite number; 0 is used (the "
                    "first of 2)"))
        << loaded.said;
    for (const Vec2& uv : loaded.model.primitives[0].uvs)
        EXPECT_TRUE(std::isfinite(uv.x) && std::isfinite(uv.y));
    text = cube_text();
    replace("-0.500000\n", "-0.500000 inf 0 0\n");
    put(folder / "q.obj", "vn 1 inf 0\n" + text);
    const Loaded flawed = load_and_listen(folder / "q.obj");
    EXPECT_TRUE(flawed.says("q.obj:1: a normal is not a finite number")) << flawed.said;
    EXPECT_TRUE(flawed.says("q.obj:2: a vertex colour is not a finite number")) << flawed.said;
    for (const Vec4& color : flawed.model.primitives[0].colors)
        EXPECT_TRUE(is_finite(Vec3(color)));
}

TEST(Obj, IndicesToNothingLeaveTheAttributeOut) {
    const fs::path folder = fresh_folder("obj_indices");
    const std::string positions = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    put(folder / "a.obj", positions + "f 1//1 2//1 3//1\n");
    Loaded loaded = load_and_listen(folder / "a.obj");
    EXPECT_TRUE(loaded.says("a.obj:4: a corner refers to a normal, but the file has none"))
        << loaded.said;
    EXPECT_EQ(loaded.model.primitives[0].normals[0], Vec3(0, 0, 1));
    put(folder / "a.obj", positions + "f 1/1 2/1 3/1\n");
    loaded = load_and_listen(folder / "a.obj");
    EXPECT_TRUE(loaded.says("refers to a texture coordinate, but the file has none"))
        << loaded.said;
    EXPECT_TRUE(loaded.model.primitives[0].uvs.empty());
    for (const std::string index : {"7", "0", "-7"}) {
        put(folder / "a.obj", positions + "vt 0.25 0.5\nf 1/1 2/1 3/" + index + "\n");
        loaded = load_and_listen(folder / "a.obj");
        EXPECT_TRUE(loaded.says("outside the file's 1")) << index << loaded.said;
        EXPECT_EQ(loaded.model.primitives[0].uvs.size(), 3u);
    }
    // An index of a position that does not exist is an error.
    for (const std::string index : {"7", "0", "-7"}) {
        put(folder / "a.obj", positions + "f 1 2 " + index + "\n");
        EXPECT_THROW(load_model(folder / "a.obj"), InputError) << index;
    }
}

TEST(Obj, SmoothingGroupsPartNormals) {
    const fs::path folder = fresh_folder("obj_smoothing");
    const auto vertices = [&](const std::string& statement) {
        put(folder / "q.obj", cube_text({}, 1, statement));
        const Model model = load_model(folder / "q.obj");
        float largest = 0.0f;  // largest component of a normal; 1 on a flat cube
        for (const Vec3& n : model.primitives[0].normals)
            largest = std::max({largest, std::abs(n.x), std::abs(n.y), std::abs(n.z)});
        return largest;
    };
    EXPECT_EQ(vertices("s off\n"), 1.0f);
    EXPECT_EQ(vertices("s 0\n"), 1.0f);
    EXPECT_LT(vertices("s 1\n"), 0.9f);
    EXPECT_LT(vertices("s on\n"), 0.9f);
    EXPECT_LT(vertices(""), 0.9f);
    // The two smoothing groups are smooth inside and meet at a sharp edge.
    const std::string faces =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\ns 1\nf 1 3 2\ns 2\nf 1 2 5 4\n";
    put(folder / "q.obj", faces);
    const Model parted = load_model(folder / "q.obj");
    EXPECT_EQ(parted.primitives[0].positions.size(), 7u);
    EXPECT_EQ(parted.primitives[0].normals[parted.primitives[0].indices[0]], Vec3(0, 0, -1));
    EXPECT_EQ(parted.primitives[0].normals[parted.primitives[0].indices[3]], Vec3(0, -1, 0));
    // Flat shading survives writing and reading.
    put(folder / "q.obj", cube_text({}, 1, "s off\n"));
    const Model flat = load_model(folder / "q.obj");
    save_model(folder / "again.glb", flat);
    expect_same_triangles(flat, load_model(folder / "again.glb"), 1e-6f);
}

TEST(Obj, WhatIsWhollyInvisibleIsTakenAsOpaque) {
    const fs::path folder = fresh_folder("obj_invisible");
    put(folder / "q.obj", "mtllib m.mtl\n" + cube_text({}, 1, "usemtl a\n"));
    for (const std::string opacity : {"Tr 1.000000", "d 0", "d 0\nTr 1", "d -halo 0.0"}) {
        put(folder / "m.mtl", "newmtl a\n" + opacity + "\n");
        const Loaded loaded = load_and_listen(folder / "q.obj");
        EXPECT_TRUE(loaded.says("fully transparent")) << opacity << loaded.said;
        EXPECT_EQ(loaded.model.materials[0].base_color_factor.w, 1.0f);
        EXPECT_EQ(loaded.model.materials[0].alpha, Material::Alpha::opaque);
    }
    for (const std::string opacity : {"d 1\nTr 1", "Tr 0", "Tr 1\nd 1"}) {
        put(folder / "m.mtl", "newmtl a\n" + opacity + "\n");
        const Loaded loaded = load_and_listen(folder / "q.obj");
        EXPECT_EQ(loaded.said, "") << opacity;
        EXPECT_EQ(loaded.model.materials[0].base_color_factor.w, 1.0f);
    }
    // One fully transparent material among others may be intended. It stays, with a warning.
    put(folder / "m.mtl", "newmtl a\nd 0\nnewmtl b\nKd 1 0 0\n");
    put(folder / "q.obj",
        "mtllib m.mtl\n" + cube_text({}, 1, "usemtl a\n") + "usemtl b\nf 1/1 2/2 8/3\n");
    const Loaded mixed = load_and_listen(folder / "q.obj");
    EXPECT_EQ(mixed.model.materials[0].base_color_factor.w, 0.0f);
    EXPECT_TRUE(mixed.says("material 'a' is fully transparent")) << mixed.said;
}

TEST(Obj, AnOpacityMapOfItsOwnCutsOut) {
    const fs::path folder = fresh_folder("obj_map_d");
    put(folder / "q.obj", "mtllib m.mtl\n" + cube_text({}, 1, "usemtl a\n"));
    put_red(folder / "t.png");
    Image half(8, 8, 1, 1.0f);
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 4; ++x)
            half.at(x, y, 0) = 0.0f;
    }
    save_image(folder / "alpha.png", half);
    put(folder / "m.mtl", "newmtl a\nmap_Kd t.png\nmap_d alpha.png\n");
    const auto check = [](const Model& model, const Vec3& color) {
        const Material& material = model.materials[0];
        EXPECT_EQ(material.alpha, Material::Alpha::blend);
        const Image& image = model.textures.at(material.base_color_texture).image;
        ASSERT_EQ(image.channels, 4);
        EXPECT_EQ(image.at(1, 3, 3), 0.0f);
        EXPECT_EQ(image.at(6, 3, 3), 1.0f);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(image.at(6, 3, c), color[c], 1e-5f);
    };
    const Model model = load_model(folder / "q.obj");
    check(model, Vec3(1, 0, 0));
    save_model(folder / "again.obj", model);
    check(load_model(folder / "again.obj"), Vec3(1, 0, 0));
    // The material has no base colour image, and its opacity is one channel of an image.
    Image packed(8, 8, 3, 0.5f);
    for (int i = 0; i < 64; ++i)
        packed.pixels[static_cast<std::size_t>(3 * i + 1)] = half.pixels[i];
    save_image(folder / "packed.png", packed);
    put(folder / "m.mtl", "newmtl a\nKd 0 1 0\nmap_d -imfchan g packed.png\n");
    const Model green = load_model(folder / "q.obj");
    check(green, Vec3(1));
    EXPECT_EQ(green.materials[0].base_color_factor, Vec4(0, 1, 0, 1));
    // One image is both base colour and opacity map. Its own alpha counts, and here it has none.
    put(folder / "m.mtl", "newmtl a\nmap_Kd t.png\nmap_d t.png\n");
    EXPECT_EQ(load_model(folder / "q.obj").textures[0].image.channels, 3);
    put(folder / "m.mtl", "newmtl a\nmap_Pr -imfchan g packed.png\nmap_Pm -imfchan b packed.png\n");
    const Model orm = load_model(folder / "q.obj");
    const Image& image = orm.textures.at(orm.materials[0].metallic_roughness_texture).image;
    EXPECT_EQ(image.at(1, 3, 1), 0.0f);
    EXPECT_NEAR(image.at(1, 3, 2), 0.5f, 0.01f);
}

}  // namespace
}  // namespace item3d
