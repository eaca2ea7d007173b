#include "item3d/io/gltf/finite_attributes.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/accessors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>
#include <utility>

namespace item3d {
namespace {

/// The elements of an accessor in a buffer.
struct Elements {
    std::uint8_t* first;
    std::size_t count, stride, components;
    std::size_t buffer;  ///< index in SourceDocument::buffers
};

bool is_finite(const Elements& elements) {
    constexpr std::uint32_t exponent = 0x7f800000;  // all bits are set in infinities and NaN
    std::uint32_t largest = 0;
    for (std::size_t i = 0; i < elements.count; ++i)
        for (std::size_t c = 0; c < elements.components; ++c) {
            std::uint32_t bits;
            std::memcpy(&bits, elements.first + i * elements.stride + 4 * c, 4);
            largest = std::max(largest, bits & exponent);
        }
    return largest != exponent;
}

/// Returns the number of elements that were replaced by `value`.
std::size_t replace(const Elements& elements, float value) {
    std::size_t replaced = 0;
    for (std::size_t i = 0; i < elements.count; ++i) {
        std::vector<float> element(elements.components);
        std::uint8_t* at = elements.first + i * elements.stride;
        std::memcpy(element.data(), at, 4 * element.size());
        if (std::all_of(element.begin(), element.end(), [](float v) { return std::isfinite(v); }))
            continue;
        element.assign(element.size(), value);
        std::memcpy(at, element.data(), 4 * element.size());
        ++replaced;
    }
    return replaced;
}

class Repair {
  public:
    explicit Repair(SourceDocument& document) : document_(document) {}

    std::vector<std::string> run() {
        const GltfObject root = root_of(document_);
        for (std::size_t m = 0; m < root.list_size("meshes"); ++m) {
            try {
                visit_mesh(root.item("meshes", m));
            } catch (const InputError&) {
                // If the mesh is used, its reader reports the error.
            }
        }
        for (const std::size_t buffer : document_.repaired_buffers) {
            Json& described = document_.json["buffers"][buffer];
            if (is_data_uri(described.value("uri", std::string())))
                described["uri"] = "data:application/octet-stream;base64," +
                                   encode_base64(document_.buffers[buffer]);
        }
        return std::move(warnings_);
    }

  private:
    void visit_mesh(const GltfObject& mesh) {
        for (std::size_t p = 0; p < mesh.list_size("primitives"); ++p) {
            const GltfObject primitive = mesh.item("primitives", p);
            if (const auto attributes = primitive.object("attributes")) visit(*attributes);
            for (std::size_t t = 0; t < primitive.list_size("targets"); ++t)
                visit(primitive.item("targets", t));
        }
    }

    void visit(const GltfObject& attributes) {
        const Json positions = attributes.json().value("POSITION", Json());
        for (const auto& [name, accessor] : attributes.json().items())
            if (accessor != positions && accessor.is_number_unsigned())
                repair(attributes, name, accessor.get<std::size_t>());
    }

    void repair(const GltfObject& attributes, const std::string& name, std::size_t accessor) {
        if (!done_.insert(accessor).second) return;
        const bool is_color = name.starts_with("COLOR_");
        std::size_t replaced = 0, count = 0;
        try {
            for (const Elements& elements : elements_of(accessor)) {
                count += elements.count;
                if (is_finite(elements)) continue;
                replaced += replace(elements, is_color ? 1.0f : 0.0f);
                document_.repaired_buffers.insert(elements.buffer);
            }
        } catch (const InputError&) {
            return;  // if the attribute is used, its reader reports the error
        }
        if (replaced > 0)
            warnings_.push_back(
                fmt::format("{}: {}: {} of {} elements of {} are not finite numbers; {} is used",
                            document_.path.string(), attributes.where(), replaced, count, name,
                            is_color ? 1 : 0));
    }

    /// Returns the accessor's own elements and those of its sparse substitution.
    std::vector<Elements> elements_of(std::size_t index) {
        std::vector<Elements> found;
        const Accessor shape = accessor_shape(document_, index);
        if (shape.component_type != ComponentType::f32 || shape.type.starts_with("MAT") ||
            document_.decoded_accessors.contains(index))
            return found;
        const GltfObject accessor = root_of(document_).item("accessors", index);
        add(accessor, shape, shape.count, found);
        if (const auto sparse = accessor.object("sparse"))
            if (const auto values = sparse->object("values"))
                add(*values, shape, sparse->integer("count"), found);
        return found;
    }

    /// object: an accessor, or the values of its sparse substitution.
    void add(const GltfObject& object, const Accessor& shape, std::size_t count,
             std::vector<Elements>& found) {
        const GltfObject root = root_of(document_);
        const auto index = object.index("bufferView", root.list_size("bufferViews"));
        if (!index || count == 0 || document_.decoded_views.contains(*index)) return;
        const GltfObject view = root.item("bufferViews", *index);
        const auto bytes = byte_range(document_, view);
        const std::size_t stride =
            std::max(view.integer("byteStride", shape.element_size), shape.element_size);
        const std::size_t offset = object.integer("byteOffset", 0);
        if (bytes.size() < offset + shape.element_size ||
            (bytes.size() - offset - shape.element_size) / stride + 1 < count)
            return;
        const std::size_t buffer = view.integer("buffer");
        Bytes& own = document_.buffers[buffer];
        const auto begin = static_cast<std::size_t>(bytes.data() - own.data()) + offset;
        found.push_back({own.data() + begin, count, stride, shape.components, buffer});
    }

    SourceDocument& document_;
    std::set<std::size_t> done_;  ///< indices of accessors
    std::vector<std::string> warnings_;
};

}  // namespace

std::vector<std::string> replace_not_finite(SourceDocument& document) {
    return Repair(document).run();
}

}  // namespace item3d
