#include "item3d/io/gltf/draco.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/accessors.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <new>

namespace item3d {
namespace {

/// Limits of a mesh, checked before each allocation of decoding.
struct Limits {
    std::size_t points;
    std::size_t faces;
    std::size_t attributes;
    std::size_t attribute_bytes;
};

/// A decoder of the library, which trusts the sizes in its stream, with checks between its steps.
template <typename Decoder>
class BoundedDecoder : public Decoder {
  public:
    explicit BoundedDecoder(const Limits& limits) : limits_(limits) {}

  protected:
    bool DecodeConnectivity() override {
        draco::DecoderBuffer ahead = *this->buffer();
        std::uint32_t first = 0, second = 0;
        if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) {
            return false;
        }
        constexpr bool is_sequential = std::is_same_v<Decoder, draco::MeshSequentialDecoder>;
        const std::uint32_t points = is_sequential ? second : first;
        const std::uint32_t faces = is_sequential ? first : second;
        return points <= limits_.points && faces <= limits_.faces &&
               Decoder::DecodeConnectivity() && this->mesh()->num_points() <= limits_.points;
    }

    bool DecodeAllAttributes() override {
        // Damaged data can cost some seconds and 256 MB for each attribute, inside the library.
        if (static_cast<std::size_t>(this->mesh()->num_attributes()) > limits_.attributes) {
            return false;
        }
        std::size_t bytes_of_point = 0;
        for (int i = 0; i < this->mesh()->num_attributes(); ++i) {
            bytes_of_point += static_cast<std::size_t>(this->mesh()->attribute(i)->byte_stride());
        }
        const std::size_t points = std::max<std::size_t>(1, this->mesh()->num_points());
        return bytes_of_point <= limits_.attribute_bytes / points && Decoder::DecodeAllAttributes();
    }

  private:
    Limits limits_;
};

draco::Status decode_mesh(std::span<const std::uint8_t> bytes, const Limits& limits,
                          draco::Mesh& mesh) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::DecoderBuffer ahead = buffer;
    draco::DracoHeader header;
    const draco::Status status = draco::PointCloudDecoder::DecodeHeader(&ahead, &header);
    if (!status.ok()) return status;
    // The extension requires this version of the bitstream; older versions have other headers.
    if (header.encoder_type != draco::TRIANGULAR_MESH || header.version_major != 2 ||
        header.version_minor != 2) {
        return draco::Status(draco::Status::UNSUPPORTED_VERSION,
                             "expected a mesh of bitstream version 2.2");
    }
    const draco::DecoderOptions options;
    if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
        return BoundedDecoder<draco::MeshSequentialDecoder>(limits).Decode(options, &buffer, &mesh);
    }
    return BoundedDecoder<draco::MeshEdgebreakerDecoder>(limits).Decode(options, &buffer, &mesh);
}

template <typename T>
bool convert(const draco::PointAttribute& attribute, std::uint32_t points, std::size_t components,
             Bytes& bytes) {
    std::vector<T> values(points * components);
    for (std::uint32_t i = 0; i < points; ++i) {
        const draco::AttributeValueIndex place = attribute.mapped_index(draco::PointIndex(i));
        if (place.value() >= attribute.size() ||
            !attribute.ConvertValue(place, static_cast<std::int8_t>(components),
                                    &values[i * components])) {
            return false;
        }
    }
    const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
    bytes.assign(first, first + values.size() * sizeof(T));
    return true;
}

bool convert(const draco::PointAttribute& attribute, std::uint32_t points, const Accessor& shape,
             Bytes& bytes) {
    const std::size_t components = shape.components;
    switch (shape.component_type) {
        case ComponentType::i8:
            return convert<std::int8_t>(attribute, points, components, bytes);
        case ComponentType::u8:
            return convert<std::uint8_t>(attribute, points, components, bytes);
        case ComponentType::i16:
            return convert<std::int16_t>(attribute, points, components, bytes);
        case ComponentType::u16:
            return convert<std::uint16_t>(attribute, points, components, bytes);
        case ComponentType::u32:
            return convert<std::uint32_t>(attribute, points, components, bytes);
        case ComponentType::f32:
            break;
    }
    return convert<float>(attribute, points, components, bytes);
}

class DracoPrimitive {
  public:
    DracoPrimitive(SourceDocument& document, const GltfObject& primitive)
        : document_(document),
          root_(root_of(document)),
          primitive_(primitive),
          extension_(*primitive.object("extensions")->object(draco_extension)) {}

    void decode() {
        if (primitive_.integer("mode", 4) != 4) {
            primitive_.fail("a Draco mesh must consist of triangles (mode 4)", damaged_data);
        }
        const auto attributes = primitive_.object("attributes");
        const auto ids = extension_.object("attributes");
        if (!attributes || !ids) extension_.fail("attributes are missing", damaged_data);
        const std::size_t indices = accessor_of(primitive_, "indices");
        const std::size_t position = accessor_of(*attributes, "POSITION");
        if (!document_.decoded_primitives.insert(primitive_.where()).second) return;

        draco::Mesh mesh;
        read_mesh(accessor_shape(document_, position).count,
                  accessor_shape(document_, indices).count / 3,
                  std::max<std::size_t>(8, ids->json().size()), mesh);
        put(indices, triangles(mesh, accessor_shape(document_, indices)));
        for (const auto& [name, id] : ids->json().items()) {
            put(accessor_of(*attributes, name.c_str()),
                values(mesh, name, ids->integer(name.c_str()),
                       accessor_shape(document_, accessor_of(*attributes, name.c_str()))));
        }
        if (!document_.decoded_accessors.contains(position)) {
            extension_.fail("POSITION is not among the compressed attributes", damaged_data);
        }
    }

  private:
    std::size_t accessor_of(const GltfObject& object, const char* key) const {
        const auto index = object.index(key, root_.list_size("accessors"));
        if (!index)
            object.fail(std::string(key) + " is missing, but Draco data requires it", damaged_data);
        return *index;
    }

    // Returns how many further bytes may be decompressed. In valid files the decompressed data are
    // some dozens of times as large as the file.
    std::size_t bytes_left() const {
        std::size_t size_of_file = 0, taken = 0;
        for (const Bytes& buffer : document_.buffers)
            size_of_file += buffer.size();
        for (const auto& [accessor, bytes] : document_.decoded_accessors)
            taken += bytes.size();
        const std::size_t limit = std::max<std::size_t>(1 << 26, 1024 * size_of_file);
        return limit - std::min(limit, taken);
    }

    void read_mesh(std::size_t points, std::size_t faces, std::size_t attributes,
                   draco::Mesh& mesh) const {
        const auto view = extension_.index("bufferView", root_.list_size("bufferViews"));
        if (!view) extension_.fail("bufferView is missing", damaged_data);
        const std::size_t left = bytes_left();
        if (faces > left / 12 || points > left / 12) {
            extension_.fail(fmt::format("{} vertices and {} triangles are more than the compressed "
                                        "data can hold",
                                        points, faces),
                            damaged_data);
        }
        const draco::Status status = decode_mesh(buffer_view_bytes(document_, *view),
                                                 {points, faces, attributes, left}, mesh);
        if (!status.ok()) {
            extension_.fail(
                fmt::format("its Draco data cannot be read as {} vertices and {} triangles ({})",
                            points, faces, status.error_msg()),
                damaged_data);
        }
        // The encoder drops triangles without area, which some exporters still count.
        if (mesh.num_points() != points || mesh.num_faces() > faces) {
            extension_.fail(fmt::format("its Draco data has {} vertices and {} triangles, the "
                                        "accessors {} and {}",
                                        mesh.num_points(), mesh.num_faces(), points, faces),
                            damaged_data);
        }
    }

    Bytes triangles(const draco::Mesh& mesh, const Accessor& shape) const {
        const std::size_t size = shape.element_size;
        if (shape.components != 1 || shape.component_type == ComponentType::f32) {
            primitive_.fail("indices must be unsigned integers", damaged_data);
        }
        Bytes bytes(3 * mesh.num_faces() * size);
        std::uint8_t* out = bytes.data();
        for (std::uint32_t face = 0; face < mesh.num_faces(); ++face) {
            for (int corner = 0; corner < 3; ++corner) {
                const std::uint32_t point =
                    mesh.face(draco::FaceIndex(face))[static_cast<std::size_t>(corner)].value();
                if (point >= mesh.num_points() || (size < 4 && point >> (8 * size)) != 0) {
                    extension_.fail(fmt::format("index {} of {} vertices, in {} bytes", point,
                                                mesh.num_points(), size),
                                    damaged_data);
                }
                for (std::size_t byte = 0; byte < size; ++byte)
                    *out++ = static_cast<std::uint8_t>(point >> (8 * byte));
            }
        }
        return bytes;
    }

    Bytes values(const draco::Mesh& mesh, const std::string& name, std::size_t id,
                 const Accessor& shape) const {
        const draco::PointAttribute* attribute =
            id <= std::numeric_limits<std::uint32_t>::max()
                ? mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id))
                : nullptr;
        if (!attribute) {
            extension_.fail(
                fmt::format("{} is attribute {}, which is missing in its Draco data", name, id),
                damaged_data);
        }
        if (attribute->num_components() != shape.components || shape.type.starts_with("MAT") ||
            shape.count != mesh.num_points()) {
            extension_.fail(
                fmt::format("{} has {} numbers for each of {} vertices, but its accessor has {} {}",
                            name, attribute->num_components(), mesh.num_points(), shape.count,
                            shape.type),
                damaged_data);
        }
        const std::size_t stored =
            attribute->size() *
            static_cast<std::size_t>(std::max<std::int64_t>(0, attribute->byte_stride()));
        const bool is_whole = attribute->buffer() && attribute->buffer()->data_size() >= stored &&
                              (attribute->is_mapping_identity() ||
                               attribute->indices_map_size() >= mesh.num_points());
        Bytes bytes;
        if (!is_whole || !convert(*attribute, mesh.num_points(), shape, bytes)) {
            extension_.fail(
                fmt::format("the values of {} cannot be read as described by its accessor", name),
                damaged_data);
        }
        return bytes;
    }

    // Stores a compressed attribute. Its accessor must belong to one primitive, since nothing else
    // defines its content.
    void put(std::size_t accessor, Bytes bytes) {
        const auto [place, is_new] = document_.decoded_accessors.try_emplace(accessor);
        if (!is_new && place->second != bytes) {
            extension_.fail(fmt::format("accessor {} is also used by other Draco data", accessor),
                            damaged_data);
        }
        place->second = std::move(bytes);
    }

    SourceDocument& document_;
    GltfObject root_;
    const GltfObject& primitive_;
    GltfObject extension_;
};

bool has_draco(const Json& primitive) {
    const auto extensions = primitive.find("extensions");
    return extensions != primitive.end() && extensions->contains(draco_extension);
}

}  // namespace

bool needs_draco(const SourceDocument& document, const GltfObject& primitive) {
    const auto extensions = primitive.object("extensions");
    const auto extension = extensions ? extensions->object(draco_extension) : std::nullopt;
    const auto attributes = primitive.object("attributes");
    if (!extension || !attributes) return false;
    const GltfObject root = root_of(document);
    const auto is_bare = [&](const GltfObject& object, const char* key) {
        const auto index = object.index(key, root.list_size("accessors"));
        return index && !root.item("accessors", *index).has("bufferView");
    };
    if (is_bare(primitive, "indices")) return true;
    const auto ids = extension->object("attributes");
    if (!ids) return false;
    for (const auto& [name, id] : ids->json().items()) {
        if (is_bare(*attributes, name.c_str())) return true;
    }
    return false;
}

void decode_draco_primitive(SourceDocument& document, const GltfObject& primitive) {
    try {
        DracoPrimitive(document, primitive).decode();
    } catch (const std::bad_alloc&) {
        primitive.fail("its Draco data needs more memory than available", damaged_data);
    }
}

// Attributes that were renamed or dropped in the primitive are also renamed or dropped in the
// extension. Attributes that are new and uncompressed are removed from it, since compressed values
// would override them.
void match_draco(const Json& original, Json& primitive) {
    if (!has_draco(primitive)) return;
    Json& extension = primitive["extensions"][draco_extension];
    if (!extension.contains("attributes")) return;
    const Json old_ids = extension["attributes"];
    Json ids = Json::object();
    for (const auto& [name, accessor] : primitive["attributes"].items()) {
        for (const auto& [old_name, id] : old_ids.items()) {
            const auto old_accessor = original["attributes"].find(old_name);
            if (old_accessor != original["attributes"].end() && *old_accessor == accessor)
                ids[name] = id;
        }
    }
    extension["attributes"] = std::move(ids);
}

}  // namespace item3d
