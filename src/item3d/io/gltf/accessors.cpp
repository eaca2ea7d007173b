#include "item3d/io/gltf/accessors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace item3d {
namespace {

struct ElementShape {
    const char* name;
    std::size_t components;
    std::size_t columns;
};
constexpr ElementShape element_shapes[] = {{"SCALAR", 1, 1}, {"VEC2", 2, 1}, {"VEC3", 3, 1},
                                           {"VEC4", 4, 1},   {"MAT2", 4, 2}, {"MAT3", 9, 3},
                                           {"MAT4", 16, 4}};

ComponentType read_component_type(const GltfObject& object) {
    const std::size_t number = object.integer("componentType");
    switch (number) {
        case 5120:
        case 5121:
        case 5122:
        case 5123:
        case 5125:
        case 5126:
            return static_cast<ComponentType>(number);
        default:
            object.fail(fmt::format("componentType {} is unknown", number));
    }
}

bool is_unsigned(ComponentType type) {
    return type == ComponentType::u8 || type == ComponentType::u16 || type == ComponentType::u32;
}

// Checks a range of `count` elements of `size` bytes, `stride` bytes apart, from `offset` on.
void check_range(const GltfObject& object, std::size_t available, std::size_t offset,
                 std::size_t stride, std::size_t size, std::size_t count) {
    if (count == 0) return;
    const bool fits = offset <= available && size <= available - offset &&
                      (count - 1) <= (available - offset - size) / stride;
    if (!fits) {
        object.fail(
            fmt::format("{} elements of {} bytes from byte {} exceed a buffer view of {} bytes",
                        count, size, offset, available),
            "the file is damaged or cut short; export it again");
    }
}

void apply_sparse(const SourceDocument& document, const GltfObject& sparse, Accessor& accessor) {
    const std::size_t views = root_of(document).list_size("bufferViews");
    const std::size_t count = sparse.integer("count");
    const auto indices = sparse.object("indices");
    const auto values = sparse.object("values");
    if (!indices || !values) sparse.fail("indices or values are missing");
    const auto index_view = indices->index("bufferView", views);
    const auto value_view = values->index("bufferView", views);
    if (!index_view || !value_view) sparse.fail("bufferView is missing");
    Accessor places;
    places.component_type = read_component_type(*indices);
    places.element_size = component_size(places.component_type);
    if (!is_unsigned(places.component_type)) indices->fail("indices must be unsigned integers");
    const auto index_bytes = buffer_view_bytes(document, *index_view);
    const auto value_bytes = buffer_view_bytes(document, *value_view);
    const std::size_t index_offset = indices->integer("byteOffset", 0);
    const std::size_t value_offset = values->integer("byteOffset", 0);
    check_range(*indices, index_bytes.size(), index_offset, places.element_size,
                places.element_size, count);
    check_range(*values, value_bytes.size(), value_offset, accessor.element_size,
                accessor.element_size, count);
    if (count == 0) return;
    places.count = count;
    const auto first = index_bytes.begin() + static_cast<std::ptrdiff_t>(index_offset);
    places.bytes.assign(first, first + static_cast<std::ptrdiff_t>(count * places.element_size));
    for (std::size_t i = 0; i < count; ++i) {
        const double place = places.raw(i, 0);
        if (place >= static_cast<double>(accessor.count)) {
            sparse.fail(fmt::format("index {} of {} elements", place, accessor.count));
        }
        std::memcpy(accessor.bytes.data() + static_cast<std::size_t>(place) * accessor.element_size,
                    value_bytes.data() + value_offset + i * accessor.element_size,
                    accessor.element_size);
    }
}

template <typename T>
double load(const std::uint8_t* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
}

}  // namespace

std::size_t component_size(ComponentType type) {
    switch (type) {
        case ComponentType::i8:
        case ComponentType::u8:
            return 1;
        case ComponentType::i16:
        case ComponentType::u16:
            return 2;
        default:
            return 4;
    }
}

double Accessor::raw(std::size_t element, std::size_t component) const {
    const std::size_t size = component_size(component_type);
    std::size_t offset = component * size;
    // Columns of matrices start at multiples of four bytes.
    if (padded_rows > 0)
        offset = component / padded_rows * ((padded_rows * size + 3) / 4 * 4) +
                 component % padded_rows * size;
    const std::uint8_t* at = bytes.data() + element * element_size + offset;
    switch (component_type) {
        case ComponentType::i8:
            return load<std::int8_t>(at);
        case ComponentType::u8:
            return load<std::uint8_t>(at);
        case ComponentType::i16:
            return load<std::int16_t>(at);
        case ComponentType::u16:
            return load<std::uint16_t>(at);
        case ComponentType::u32:
            return load<std::uint32_t>(at);
        case ComponentType::f32:
            break;
    }
    return load<float>(at);
}

float Accessor::value(std::size_t element, std::size_t component) const {
    const double stored = raw(element, component);
    if (!normalized) return static_cast<float>(stored);
    switch (component_type) {
        case ComponentType::i8:
            return static_cast<float>(std::max(stored / 127.0, -1.0));
        case ComponentType::u8:
            return static_cast<float>(stored / 255.0);
        case ComponentType::i16:
            return static_cast<float>(std::max(stored / 32767.0, -1.0));
        case ComponentType::u16:
            return static_cast<float>(stored / 65535.0);
        default:
            return static_cast<float>(stored);
    }
}

Accessor accessor_shape(const SourceDocument& document, std::size_t index) {
    const GltfObject object = root_of(document).item("accessors", index);
    Accessor accessor;
    accessor.component_type = read_component_type(object);
    accessor.type = object.text("type", "");
    accessor.count = object.integer("count");
    accessor.normalized = object.boolean("normalized", false);
    const auto* shape =
        std::find_if(std::begin(element_shapes), std::end(element_shapes),
                     [&](const ElementShape& s) { return accessor.type == s.name; });
    if (shape == std::end(element_shapes)) object.fail("type '" + accessor.type + "' is unknown");
    accessor.components = shape->components;
    if (shape->columns == 2 || shape->columns == 3) accessor.padded_rows = shape->columns;
    const std::size_t column =
        shape->components / shape->columns * component_size(accessor.component_type);
    accessor.element_size = shape->columns == 1 ? column : shape->columns * ((column + 3) / 4 * 4);
    return accessor;
}

Accessor read_accessor(const SourceDocument& document, std::size_t index) {
    const GltfObject root = root_of(document);
    const GltfObject object = root.item("accessors", index);
    Accessor accessor = accessor_shape(document, index);
    const auto decoded = document.decoded_accessors.find(index);
    if (decoded != document.decoded_accessors.end()) {
        accessor.bytes = decoded->second;
        accessor.count = accessor.bytes.size() / accessor.element_size;
    } else if (const auto view_index = object.index("bufferView", root.list_size("bufferViews"))) {
        const auto view = buffer_view_bytes(document, *view_index);
        const std::size_t offset = object.integer("byteOffset", 0);
        std::size_t stride = root.item("bufferViews", *view_index).integer("byteStride", 0);
        if (stride == 0) stride = accessor.element_size;
        if (stride < accessor.element_size) object.fail("byteStride is smaller than an element");
        check_range(object, view.size(), offset, stride, accessor.element_size, accessor.count);
        accessor.bytes.resize(accessor.count * accessor.element_size);
        for (std::size_t i = 0; i < accessor.count; ++i) {
            std::memcpy(accessor.bytes.data() + i * accessor.element_size,
                        view.data() + offset + i * stride, accessor.element_size);
        }
    } else {
        // An accessor without a buffer view contains zeros. No data limit its count, so the size of
        // the file is the limit.
        std::size_t size_of_file = 0;
        for (const Bytes& buffer : document.buffers)
            size_of_file += buffer.size();
        if (accessor.count > std::max<std::size_t>(1 << 16, size_of_file)) {
            object.fail(fmt::format("{} elements without a buffer view", accessor.count));
        }
        accessor.bytes.assign(accessor.count * accessor.element_size, 0);
    }
    if (const auto sparse = object.object("sparse")) apply_sparse(document, *sparse, accessor);
    return accessor;
}

Accessor read_vectors(const SourceDocument& document, std::size_t index, std::size_t min_components,
                      std::size_t max_components) {
    Accessor accessor = read_accessor(document, index);
    if (accessor.components < min_components || accessor.components > max_components ||
        accessor.type.starts_with("MAT")) {
        root_of(document)
            .item("accessors", index)
            .fail("type " + accessor.type + " is not allowed here");
    }
    return accessor;
}

std::vector<std::uint32_t> read_indices(const SourceDocument& document, std::size_t index) {
    const Accessor accessor = read_vectors(document, index, 1, 1);
    if (!is_unsigned(accessor.component_type)) {
        root_of(document).item("accessors", index).fail("indices must be unsigned integers");
    }
    std::vector<std::uint32_t> indices(accessor.count);
    for (std::size_t i = 0; i < accessor.count; ++i) {
        indices[i] = static_cast<std::uint32_t>(accessor.raw(i, 0));
    }
    return indices;
}

}  // namespace item3d
