// A glTF document in memory: its JSON and the bytes of its buffers, kept beside the model so that
// an edited copy can be written by patching it. Internal to io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/resources.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace item3d {

/// JSON that keeps the order of keys.
using Json = nlohmann::ordered_json;

/// Advice for invalid JSON values and data.
inline constexpr const char* damaged_file = "the file is damaged; export it again";
/// Advice for unreadable compressed data.
inline constexpr const char* damaged_data =
    "the file is damaged; export it again without compression";

class SourceDocument {
  public:
    std::filesystem::path path;
    Json json;
    /// Contents of the buffers in json["buffers"], as in the files. A buffer may therefore be
    /// longer than its byteLength.
    std::vector<Bytes> buffers;
    /// Decompressed data: buffer views by index (meshopt.h), and packed elements of accessors by
    /// index (draco.h).
    std::map<std::size_t, Bytes> decoded_views;
    std::map<std::size_t, Bytes> decoded_accessors;
    /// GltfObject::where() of each primitive whose data are in decoded_accessors.
    std::set<std::string> decoded_primitives;
    /// Indices of vertices in the document, one for each vertex of a primitive of the model. The
    /// key is (mesh, primitive). Only primitives whose vertices make_flat() (scene/normals.h) split
    /// have an entry.
    std::map<std::pair<int, int>, std::vector<std::uint32_t>> split_vertices;
    /// Indices of buffers that differ from their files (finite_attributes.h).
    std::set<std::size_t> repaired_buffers;
    /// True if buffers[0] is the BIN chunk of a .glb.
    bool has_binary_chunk = false;
    /// LoadOptions::texture_folders.
    std::vector<std::filesystem::path> texture_folders;
    struct Chunk {
        std::uint32_t type;
        Bytes bytes;
    };
    /// Chunks of a .glb other than JSON and BIN.
    std::vector<Chunk> other_chunks;
};

/// Reads the container, the JSON and all buffers. Throws InputError.
std::shared_ptr<SourceDocument> parse_gltf(const std::filesystem::path& path, const Bytes& bytes);

/// A JSON object of the document with its location ("meshes[0].primitives[1]"). Every access is
/// checked. Errors are InputErrors that name the file and the location.
class GltfObject {
  public:
    GltfObject(const SourceDocument& document, const Json& json, std::string where);

    const Json& json() const { return *json_; }
    const std::string& where() const { return where_; }
    bool has(const char* key) const { return json_->contains(key); }
    std::optional<GltfObject> object(const char* key) const;
    std::string text(const char* key, const std::string& otherwise) const;
    double number(const char* key, double otherwise) const;
    bool boolean(const char* key, bool otherwise) const;
    /// Returns a non-negative integer below 2^53.
    std::size_t integer(const char* key, std::size_t otherwise) const;
    std::size_t integer(const char* key) const;
    /// Returns exactly `count` numbers; empty when the key is missing.
    std::vector<double> numbers(const char* key, std::size_t count) const;
    /// Returns the length of a list; zero when the key is missing.
    std::size_t list_size(const char* key) const;
    /// Returns an object of a list.
    GltfObject item(const char* key, std::size_t index) const;
    /// Returns an integer of a list, below `limit`.
    std::size_t index_item(const char* key, std::size_t index, std::size_t limit) const;
    /// Returns an index below `limit`; no value when the key is missing.
    std::optional<std::size_t> index(const char* key, std::size_t limit) const;

    [[noreturn]] void fail(const std::string& problem,
                           const std::string& hint = damaged_file) const;

  private:
    const Json* find(const char* key) const;
    std::size_t to_integer(const Json& value, const std::string& place) const;

    const SourceDocument* document_;
    const Json* json_;
    std::string where_;
};

/// Returns the document's root object.
GltfObject root_of(const SourceDocument& document);

/// Returns the encoded bytes of an image, which are in a file, a data URI or a buffer view. Throws
/// InputError.
Bytes read_image_bytes(const SourceDocument& document, std::size_t image,
                       Forgiving forgiving = Forgiving::with_note);

/// Returns the bytes of a buffer that an object with buffer, byteOffset and byteLength denotes.
/// Throws InputError.
std::span<const std::uint8_t> byte_range(const SourceDocument& document, const GltfObject& object);

/// Returns the bytes of a buffer view, decompressed. Throws InputError.
std::span<const std::uint8_t> buffer_view_bytes(const SourceDocument& document, std::size_t view);

/// Returns json[a][b]...; null where it does not exist.
const Json* find_path(const Json& json, std::initializer_list<const char*> keys);

}  // namespace item3d
