// Tests of the claims in edited files, and of the detection of changes to these files.
#include "item3d/core/error.h"
#include "item3d/io/read_provenance.h"
#include "item3d/provenance/image_packet.h"
#include "item3d/provenance/xmp.h"
#include "tests/support/edit_folder.h"

namespace item3d {
namespace {

using namespace testing_support;

constexpr const char* author_packet =
    "<x:xmpmeta xmlns:x='adobe:ns:meta/'><rdf:RDF "
    "xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'><rdf:Description "
    "xmlns:dc='http://purl.org/dc/elements/1.1/'><dc:creator><rdf:Seq><rdf:li>Ada</rdf:li>"
    "</rdf:Seq></dc:creator></rdf:Description></rdf:RDF></x:xmpmeta>";

ModelEdit golden(ImageEncoding encoding = ImageEncoding::png) {
    ModelEdit edit;
    edit.materials[0].base_color = checkered_image(16, 16, 3);
    edit.materials[0].base_color.set_coding({encoding, false, 90});
    return edit;
}

/// Returns a quad whose texture and whose asset have metadata packets of their author.
GltfQuad quad_of_ada() {
    GltfQuad quad;
    quad.set_base_color(quad.add_texture(plain_image(4, Vec3(1, 0, 0))));
    const Bytes png = with_packet(encode_png(plain_image(4, Vec3(1, 0, 0)), 8), author_packet);
    quad.json["images"][0]["uri"] = "data:image/png;base64," + encode_base64(png);
    quad.json["asset"]["copyright"] = "2026 Ada";
    quad.json["asset"]["extensions"]["KHR_xmp_json_ld"]["packet"] = 0;
    quad.json["extensions"]["KHR_xmp_json_ld"]["packets"] = GltfJson::array({GltfJson::parse(
        R"({"@context": {"dc": "http://purl.org/dc/elements/1.1/"}, "dc:creator": {"@list": ["Ada"]}})")});
    quad.use("KHR_xmp_json_ld");
    return quad;
}

fs::path write_golden(const fs::path& folder, GltfQuad quad, const std::string& name = "out.glb",
                      ImageEncoding encoding = ImageEncoding::png,
                      std::shared_ptr<const SigningKey> key = nullptr) {
    const fs::path source = quad.write(folder);
    save_model(folder / name, load_model(source), golden(encoding),
               {{claim_to("a golden quad")}, std::move(key)});
    return folder / name;
}

Bytes embedded_image(const fs::path& path, std::size_t index) {
    const GltfFile file = read_gltf_file(path);
    return view_bytes(file, file.json["images"][index]["bufferView"]);
}

TEST(Claims, AreInModelAndTextureBesideWhatAuthorsSaid) {
    std::vector encodings = {ImageEncoding::png, ImageEncoding::jpeg, ImageEncoding::webp};
#ifdef ITEM3D_WRITES_KTX2  // the loaders-only build has no encoder
    encodings.push_back(ImageEncoding::ktx2);
#endif
    for (const ImageEncoding encoding : encodings) {
        const fs::path path =
            write_golden(fresh_folder("claims"), quad_of_ada(), "out.glb", encoding);
        const FileProvenance model = read_provenance(path);
        ASSERT_TRUE(model.has_claim());
        EXPECT_TRUE(model.is_unchanged());
        EXPECT_EQ(edits_of(model.metadata.claim), std::vector{claim_to("a golden quad")});
        EXPECT_EQ(model.metadata.creator, "Ada");
        EXPECT_EQ(model.copyright, "2026 Ada");
        EXPECT_TRUE(model.metadata.source_type.ends_with("compositeWithTrainedAlgorithmicMedia"));
        ASSERT_EQ(model.images.size(), 1u);

        const Bytes texture = embedded_image(path, 0);
        write_quickly(path.parent_path() / "texture", texture);
        const FileProvenance image = read_provenance(path.parent_path() / "texture");
        EXPECT_EQ(edits_of(image.metadata.claim), std::vector{claim_to("a golden quad")});
        EXPECT_TRUE(image.is_unchanged());
        EXPECT_EQ(image.metadata.creator, "Ada");
        EXPECT_EQ(image.images.at(0).image.sha256, model.images[0].image.sha256);
        const Model back = load_model(path);
        expect_same_image(back.textures.at(0).image, checkered_image(16, 16, 3),
                          encoding == ImageEncoding::png ? 1e-6f : 1.0f);
    }
}

// The source has a KTX2 texture. The output in another format must keep its author.
TEST(Claims, AuthorsOfKtx2StayInWhatTakesItsPlace) {
    GltfQuad quad;
    quad.set_base_color(quad.add_texture(plain_image(4, Vec3(1, 0, 0))));
    const Bytes file = with_packet(read_bytes(data_folder() / "images/uastc.ktx2"), author_packet);
    quad.json["images"][0] = {{"uri", "data:image/ktx2;base64," + encode_base64(file)},
                              {"mimeType", "image/ktx2"}};
    quad.json["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
    quad.use("KHR_texture_basisu");
    const fs::path folder = fresh_folder("claims_of_ktx2");
    write_quickly(folder / "own.ktx2", file);
    EXPECT_EQ(read_provenance(folder / "own.ktx2").metadata.creator, "Ada");
    EXPECT_FALSE(read_provenance(folder / "own.ktx2").has_claim());
    const fs::path path = write_golden(folder, quad, "out.glb", ImageEncoding::jpeg);
    const auto packet = find_packet(embedded_image(path, 0));
    ASSERT_TRUE(packet);
    EXPECT_EQ(read_xmp(*packet).creator, "Ada");
    EXPECT_EQ(edits_of(read_xmp(*packet).claim), std::vector{claim_to("a golden quad")});
}

TEST(Claims, GltfWithFilesBesideItIsTheSame) {
    const fs::path path = write_golden(fresh_folder("claims_gltf"), quad_of_ada(), "out.gltf");
    EXPECT_TRUE(read_provenance(path).is_unchanged());
    const GltfJson json = read_gltf_file(path).json;
    const fs::path image = path.parent_path() / json["images"][0]["uri"].get<std::string>();
    EXPECT_TRUE(read_provenance(image).is_unchanged());
    write_quickly(image, encode_png(plain_image(4, Vec3(0, 1, 0)), 8));
    const FileProvenance changed = read_provenance(path);
    EXPECT_EQ(changed.images.at(0).state, ContentState::changed);
    EXPECT_EQ(changed.document, ContentState::same);
    fs::remove(image);
    EXPECT_EQ(read_provenance(path).images.at(0).state, ContentState::missing);
}

TEST(Claims, NothingIsSaidWithoutAnEdit) {
    const fs::path folder = fresh_folder("claims_none");
    save_model(folder / "out.glb", load_model(GltfQuad().write(folder)), golden());
    EXPECT_FALSE(read_provenance(folder / "out.glb").has_claim());
    EXPECT_EQ(read_gltf_file(folder / "out.glb").json.dump().find("KHR_xmp"), std::string::npos);
    EXPECT_FALSE(find_packet(embedded_image(folder / "out.glb", 0)));
}

TEST(Claims, AnEditOfAnEditHasBoth) {
    const fs::path folder = fresh_folder("claims_chain");
    const fs::path first = write_golden(folder, quad_of_ada());
    ModelEdit edit;
    edit.materials[0].base_color = plain_image(16, Vec3(0, 0, 1));
    save_model(folder / "second.glb", load_model(first), edit, {{claim_to("a blue quad")}, {}});
    const FileProvenance model = read_provenance(folder / "second.glb");
    const std::vector both = {claim_to("a golden quad"), claim_to("a blue quad")};
    EXPECT_EQ(edits_of(model.metadata.claim), both);
    EXPECT_TRUE(model.is_unchanged());
    const auto packet = find_packet(embedded_image(folder / "second.glb", 0));
    ASSERT_TRUE(packet);
    EXPECT_EQ(edits_of(read_xmp(*packet).claim), both);
}

TEST(Claims, AlterationsAreNoticed) {
    const fs::path path = write_golden(fresh_folder("claims_altered"), quad_of_ada());
    const GltfFile file = read_gltf_file(path);
    const auto rewritten = [&](const GltfJson& json, const Bytes& binary) {
        // The copy is a .gltf, because that is simpler to write.
        GltfJson root = json;
        root["buffers"][0]["uri"] = "data:application/octet-stream;base64," + encode_base64(binary);
        const std::string text = root.dump();
        const fs::path copy = path.parent_path() / "copy.gltf";
        write_quickly(copy, Bytes(text.begin(), text.end()));
        return read_provenance(copy);
    };
    EXPECT_TRUE(rewritten(file.json, file.binary).is_unchanged());
    const auto flip = [&](std::size_t view) {
        Bytes binary = file.binary;
        const GltfJson& range = file.json["bufferViews"][view];
        binary[range.value("byteOffset", std::size_t{0}) + range["byteLength"].get<std::size_t>() -
               20] ^= 1;
        return rewritten(file.json, binary);
    };
    const auto image_view = file.json["images"][0]["bufferView"].get<std::size_t>();
    EXPECT_EQ(flip(image_view).images.at(0).state, ContentState::changed);
    EXPECT_EQ(flip(image_view).document, ContentState::same);
    EXPECT_EQ(flip(0).images.at(0).state, ContentState::same);
    EXPECT_EQ(flip(0).document, ContentState::changed);
    for (const auto& [pointer, value] :
         {std::pair("/asset/copyright", "Eve"),
          {"/materials/0/name", "x"},
          {"/extensions/KHR_xmp_json_ld/packets/0/dc:creator", "Eve"}}) {
        GltfJson json = file.json;
        json[GltfJson::json_pointer(pointer)] = value;
        EXPECT_EQ(rewritten(json, file.binary).document, ContentState::changed) << pointer;
    }
}

TEST(Claims, PacketsThatCannotBeUsedStayBesideTheEdits) {
    GltfQuad quad = quad_of_ada();
    GltfJson& packets = quad.json["extensions"]["KHR_xmp_json_ld"]["packets"];
    packets[0] = "broken";
    const Bytes png =
        with_packet(encode_png(plain_image(4, Vec3(1, 0, 0)), 8), "<x:xmpmeta \xff broken");
    quad.json["images"][0]["uri"] = "data:image/png;base64," + encode_base64(png);
    ::testing::internal::CaptureStderr();
    const fs::path path = write_golden(fresh_folder("claims_broken"), quad);
    EXPECT_NE(::testing::internal::GetCapturedStderr().find("not valid XML"), std::string::npos);
    EXPECT_TRUE(read_provenance(path).is_unchanged());
    EXPECT_EQ(read_gltf_file(path).json["extensions"]["KHR_xmp_json_ld"]["packets"][0], "broken");

    // Unedited parts share the packet, which therefore must not say that they were edited.
    GltfQuad shared = quad_of_ada();
    shared.json["nodes"][0]["extensions"]["KHR_xmp_json_ld"]["packet"] = 0;
    const fs::path second = write_golden(fresh_folder("claims_shared"), shared);
    const GltfJson json = read_gltf_file(second).json;
    EXPECT_EQ(json["extensions"]["KHR_xmp_json_ld"]["packets"][0],
              shared.json["extensions"]["KHR_xmp_json_ld"]["packets"][0]);
    EXPECT_EQ(json["asset"]["extensions"]["KHR_xmp_json_ld"]["packet"], 1);
    EXPECT_EQ(read_provenance(second).metadata.creator, "Ada");
    for (const char* index : {"-1", "7", "\"x\"", "{}"}) {
        GltfQuad odd = quad_of_ada();
        odd.json["asset"]["extensions"]["KHR_xmp_json_ld"]["packet"] = GltfJson::parse(index);
        EXPECT_TRUE(read_provenance(write_golden(fresh_folder("claims_odd"), odd)).is_unchanged());
    }
}

TEST(Claims, AreSigned) {
    const fs::path folder = fresh_folder("claims_signed");
    const std::string pem =
        "-----BEGIN PRIVATE KEY-----\n"
        "MC4CAQAwBQYDK2VwBCIEIJ1hsZ3v/VpguoRK9JLsLMREScVpezJpGXA7rAMcrn9g\n"
        "-----END PRIVATE KEY-----\n";
    write_quickly(folder / "key.pem", Bytes(pem.begin(), pem.end()));
    const auto key = std::make_shared<const SigningKey>(SigningKey::load(folder / "key.pem"));
    const fs::path path = write_golden(folder, quad_of_ada(), "a.glb", ImageEncoding::jpeg, key);
    EXPECT_EQ(read_provenance(path).signature, SignatureState::valid);
    EXPECT_EQ(read_bytes(path),
              read_bytes(write_golden(folder, quad_of_ada(), "b.glb", ImageEncoding::jpeg, key)));
    write_quickly(folder / "texture.jpg", embedded_image(path, 0));
    EXPECT_EQ(read_provenance(folder / "texture.jpg").signature, SignatureState::valid);
    Bytes forged = read_bytes(path);
    const std::string_view text(reinterpret_cast<const char*>(forged.data()), forged.size());
    forged[text.find("a golden quad")] = 'A';
    write_quickly(folder / "forged.glb", forged);
    EXPECT_EQ(read_provenance(folder / "forged.glb").signature, SignatureState::invalid);
    EXPECT_FALSE(read_provenance(folder / "forged.glb").is_unchanged());
    // The content is altered and its hashes are new, but they have no signature.
    save_model(folder / "other.glb", load_model(path), golden(), {{claim_to("x")}, {}});
    EXPECT_EQ(read_provenance(folder / "other.glb").signature, SignatureState::none);
}

TEST(Claims, OtherFilesHaveNone) {
    const fs::path folder = fresh_folder("claims_others");
    write_quickly(folder / "a.txt", Bytes{'h', 'i'});
    EXPECT_THROW(read_provenance(folder / "a.txt"), InputError);
    EXPECT_THROW(read_provenance(folder / "missing.glb"), InputError);
    write_quickly(folder / "a.glb", Bytes{'g', 'l', 'T', 'F', 2});
    EXPECT_THROW(read_provenance(folder / "a.glb"), InputError);
    write_quickly(folder / "plain.png", encode_png(plain_image(4, Vec3(1)), 8));
    EXPECT_FALSE(read_provenance(folder / "plain.png").has_claim());
    EXPECT_EQ(provenance_json(read_provenance(folder / "plain.png"))["claim"], nullptr);
}

}  // namespace
}  // namespace item3d
