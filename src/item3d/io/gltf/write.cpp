#include "item3d/io/gltf/write.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/find_file.h"
#include "item3d/io/gltf/claims.h"
#include "item3d/io/gltf/make.h"
#include "item3d/io/gltf/patch.h"
#include "item3d/io/gltf/references.h"
#include "item3d/io/gltf/texture_source.h"
#include "item3d/io/gltf/unused_textures.h"
#include "item3d/io/image/formats.h"
#include "item3d/io/resources.h"
#include "item3d/io/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace item3d {
namespace fs = std::filesystem;
namespace {

// Merges all buffers into one, the BIN chunk, and updates views. Keeps buffers without data, which
// extensions use.
Bytes pack_buffers(const SourceDocument& document, Json& json) {
    if (document.buffers.empty()) return {};
    if (document.has_binary_chunk && document.buffers.size() == 1) return document.buffers[0];
    Bytes binary;
    std::vector<std::size_t> new_index;
    std::vector<std::size_t> offsets;
    Json packed = Json::object();
    Json buffers = Json::array({Json::object()});
    for (std::size_t i = 0; i < document.buffers.size(); ++i) {
        const Bytes& bytes = document.buffers[i];
        if (bytes.empty()) {
            offsets.push_back(0);
            new_index.push_back(buffers.size());
            buffers.push_back(json["buffers"][i]);
            continue;
        }
        binary.resize((binary.size() + 7) / 8 * 8);
        offsets.push_back(binary.size());
        if (packed.empty()) packed = json["buffers"][i];
        new_index.push_back(0);
        binary.insert(binary.end(), bytes.begin(), bytes.end());
    }
    packed.erase("uri");
    packed["byteLength"] = binary.size();
    buffers[0] = std::move(packed);
    json["buffers"] = std::move(buffers);
    const auto move_view = [&](Json& view) {
        const auto buffer = view["buffer"].get<std::size_t>();
        view["buffer"] = new_index[buffer];
        const std::size_t offset = view.value("byteOffset", std::size_t{0}) + offsets[buffer];
        if (offset > 0) view["byteOffset"] = offset;
    };
    if (!json.contains("bufferViews")) return binary;
    for (Json& view : json["bufferViews"]) {
        move_view(view);
        if (view.contains("extensions") && view["extensions"].contains("EXT_meshopt_compression")) {
            move_view(view["extensions"]["EXT_meshopt_compression"]);
        }
    }
    return binary;
}

std::string mime_type_of(const Bytes& bytes, const Json& image) {
    if (const char* type = mime_type(detect_image_format(bytes))) return type;
    if (image.contains("mimeType")) return image["mimeType"].get<std::string>();
    return "image/png";
}

// Moves images in files and data URIs into a .glb, which must be self-contained.
void embed_images(const SourceDocument& document, GltfBuilder& builder) {
    if (!document.json.contains("images")) return;
    const std::size_t count = document.json["images"].size();
    for (std::size_t i = 0; i < count; ++i) {
        Json image = document.json["images"][i];
        if (!image.contains("uri")) continue;
        try {
            const Bytes bytes = read_image_bytes(document, i, Forgiving::silently);
            builder.embed_image(image, bytes, mime_type_of(bytes, image));
            builder.json()["images"][i] = std::move(image);
        } catch (const InputError& error) {
            warn(std::string(error.what()) + "; the reference is kept unchanged");
        }
    }
}

// Copies the files to which `json` still refers into `folder`, under the same names.
void copy_files(const SourceDocument& document, const std::map<std::string, Bytes>& new_files,
                Json& json, const fs::path& folder) {
    const std::string subject = document.path.string();
    const fs::path source = document.path.parent_path();
    for (const char* list : {"buffers", "images"}) {
        if (!json.contains(list)) continue;
        const bool are_buffers = std::string_view(list) == "buffers";
        for (std::size_t i = 0; i < json[list].size(); ++i) {
            Json& item = json[list][i];
            const std::string uri = item.value("uri", std::string());
            if (uri.empty() || is_data_uri(uri) || new_files.contains(percent_decode(uri)))
                continue;
            try {
                const fs::path from = resolve_uri(source, uri, subject, Forgiving::silently);
                std::error_code code;
                const fs::path root =
                    fs::weakly_canonical(source.empty() ? fs::path(".") : source, code);
                const fs::path relative = from.lexically_relative(root);
                // An inexact URI is replaced by the exact name of the file.
                if (!fs::exists(root / percent_decode(uri), code))
                    item["uri"] = path_to_uri(relative);
                const fs::path to = folder / percent_decode(item["uri"].get<std::string>());
                if (fs::equivalent(from, to, code)) continue;
                // Repaired buffers differ from their files.
                const bool is_repaired = are_buffers && document.repaired_buffers.contains(i);
                const Bytes bytes = is_repaired ? document.buffers[i] : read_bytes(from);
                fs::create_directories(to.parent_path(), code);
                write_atomically(to, std::span<const std::uint8_t>(bytes));
            } catch (const InputError& error) {
                warn(std::string(error.what()) + "; the reference is kept unchanged");
            }
        }
    }
}

// Cleans an edited document: removes unused textures, updates lists of extensions, and sets the
// generator.
void tidy(const SourceDocument& document, GltfBuilder& builder) {
    remove_unused_textures(document, builder);
    list_texture_extensions(builder.json());
    Json& asset = builder.json()["asset"];
    const auto generator = asset.find("generator");
    if (generator == asset.end() || !generator->is_string()) {
        asset["generator"] = "item3d";
    } else if (const auto text = generator->get<std::string>(); !text.ends_with("item3d")) {
        asset["generator"] = text + ", edited with item3d";
    }
}

/// Returns the text of a .gltf whose other files are already written.
std::string claimed_gltf(const fs::path& path, const Json& json, const SourceDocument& document,
                         const Provenance& provenance) {
    const auto text_of = [](const Json& root) {
        return root.dump(1, ' ', false, Json::error_handler_t::replace);
    };
    std::string text = text_of(json);
    if (provenance.edits.empty()) return text;
    const auto written = parse_gltf(path, Bytes(text.begin(), text.end()));
    put_claim(provenance, document, *written);
    return text_of(written->json);
}

std::vector<PrimitiveUse> primitive_uses(const Model& model, bool is_made) {
    std::vector<PrimitiveUse> uses;
    for (std::size_t i = 0; i < model.primitives.size(); ++i) {
        const Primitive& primitive = model.primitives[i];
        PrimitiveUse use{
            static_cast<int>(i),   primitive.source_mesh,     primitive.source_primitive,
            primitive.source_node, primitive.material,        primitive.is_mirrored,
            &primitive.uvs,        primitive.positions.size()};
        if (is_made) {
            use.mesh = use.node = static_cast<int>(i);
            use.primitive = 0;
            use.is_mirrored = false;
        } else {
            const std::size_t materials = model.source->json.contains("materials")
                                              ? model.source->json["materials"].size()
                                              : 0;
            if (use.material >= static_cast<int>(materials)) use.material = -1;
        }
        uses.push_back(use);
    }
    return uses;
}

}  // namespace

Bytes to_glb(const Json& json, const Bytes& binary, const SourceDocument& document) {
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    Bytes out;
    const auto put = [&](std::uint32_t value) {
        for (int shift = 0; shift < 32; shift += 8) {
            out.push_back(static_cast<std::uint8_t>(value >> shift & 255));
        }
    };
    std::size_t total = 12 + 8 + text.size();
    const auto padded = [](std::size_t size) { return (size + 3) / 4 * 4; };
    if (!binary.empty()) total += 8 + padded(binary.size());
    for (const auto& chunk : document.other_chunks)
        total += 8 + padded(chunk.bytes.size());
    if (total > std::numeric_limits<std::uint32_t>::max()) {
        throw InputError(
            "glb", fmt::format("the model needs {} bytes, which is too large for a .glb", total),
            "write a .gltf, or smaller textures");
    }
    out.reserve(total);
    const auto put_chunk = [&](std::uint32_t type, std::span<const std::uint8_t> bytes) {
        put(static_cast<std::uint32_t>(padded(bytes.size())));
        put(type);
        out.insert(out.end(), bytes.begin(), bytes.end());
        out.resize(padded(out.size()), 0);
    };
    put(0x46546c67);
    put(2);
    put(static_cast<std::uint32_t>(total));
    put_chunk(0x4e4f534a, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    if (!binary.empty()) put_chunk(0x004e4942, binary);
    for (const auto& chunk : document.other_chunks)
        put_chunk(chunk.type, chunk.bytes);
    return out;
}

Bytes claimed_glb(const fs::path& path, const Bytes& glb, const SourceDocument& source,
                  const Provenance& provenance) {
    if (provenance.edits.empty()) return glb;
    const auto written = parse_gltf(path, glb);
    put_claim(provenance, source, *written);
    return to_glb(written->json, written->has_binary_chunk ? written->buffers[0] : Bytes(),
                  *written);
}

void write_gltf(const fs::path& path, const Model& model, const ModelEdit& edit,
                const Provenance& provenance) {
    const std::shared_ptr<const SourceDocument> document =
        model.source ? model.source : make_gltf(model, edit);
    const std::vector<PrimitiveUse> uses = primitive_uses(model, !model.source);
    const auto patch = [&](GltfBuilder& builder) {
        patch_gltf(*document, uses, edit, builder);
        if (!edit.materials.empty()) tidy(*document, builder);
    };
    write_patched(path, *document, patch, provenance);
}

void write_patched(const fs::path& path, const SourceDocument& document,
                   const std::function<void(GltfBuilder&)>& patch, const Provenance& provenance) {
    const bool is_binary = to_lower(path.extension().string()) != ".gltf";
    Json json = document.json;
    // New data goes to the end of the BIN chunk, or to a new buffer.
    const bool own_buffer = !is_binary && !document.has_binary_chunk;
    Bytes binary;
    if (is_binary) {
        binary = pack_buffers(document, json);
    } else if (document.has_binary_chunk) {
        binary = document.buffers[0];
    }
    const std::size_t buffer = own_buffer ? document.buffers.size() : 0;
    GltfBuilder builder(json, buffer, std::move(binary), !is_binary, path.stem().string());
    if (is_binary) embed_images(document, builder);
    patch(builder);
    builder.finish();
    forget_unused_extensions(document.json, json);

    if (is_binary) {
        const Bytes glb = to_glb(json, builder.binary(), document);
        write_atomically(
            path, std::span<const std::uint8_t>(claimed_glb(path, glb, document, provenance)));
        return;
    }
    const fs::path folder = path.parent_path();
    // The files are copied before the new files are written. The document does not use the names of
    // the new files.
    copy_files(document, builder.files(), json, folder);
    if (!builder.binary().empty()) {
        const std::string name = builder.unused_file_name(path.stem().string(), ".bin");
        json["buffers"][buffer]["uri"] = path_to_uri(name);
        write_atomically(folder / name, std::span<const std::uint8_t>(builder.binary()));
    }
    for (const auto& [name, bytes] : builder.files()) {
        write_atomically(folder / name, std::span<const std::uint8_t>(bytes));
    }
    write_atomically(path, std::string_view(claimed_gltf(path, json, document, provenance)));
}

}  // namespace item3d
