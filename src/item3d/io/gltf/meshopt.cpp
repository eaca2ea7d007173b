#include "item3d/io/gltf/meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <string_view>

namespace item3d {
namespace {

constexpr const char* extension_name = "EXT_meshopt_compression";

/// Properties of one buffer view in the extension.
struct CompressedView {
    std::span<const std::uint8_t> bytes;
    std::size_t stride;
    std::size_t count;
    std::string mode;
    std::string filter;
};

// Checks the values that the library does not check.
void check_shape(const GltfObject& extension, const CompressedView& view) {
    const auto require = [&](bool is_right, const std::string& rule) {
        if (is_right) return;
        extension.fail(fmt::format("{}, found {} elements of {} bytes, mode {}, filter {}", rule,
                                   view.count, view.stride, view.mode, view.filter),
                       damaged_data);
    };
    if (view.mode == "ATTRIBUTES") {
        require(view.stride >= 4 && view.stride <= 256 && view.stride % 4 == 0,
                "attributes must have a multiple of 4 bytes, at most 256");
    } else if (view.mode == "TRIANGLES" || view.mode == "INDICES") {
        require(view.stride == 2 || view.stride == 4, "indices must have 2 or 4 bytes");
        require(view.mode == "INDICES" || view.count % 3 == 0,
                "the number of triangle indices must be a multiple of 3");
        require(view.filter == "NONE", "indices cannot have a filter");
    } else {
        require(false, "the mode must be ATTRIBUTES, TRIANGLES or INDICES");
    }
    if (view.filter == "OCTAHEDRAL") {
        require(view.stride == 4 || view.stride == 8, "this filter requires 4 or 8 bytes");
    } else if (view.filter == "QUATERNION") {
        require(view.stride == 8, "this filter requires 8 bytes");
    } else {
        require(view.filter == "NONE" || view.filter == "EXPONENTIAL",
                "the filter must be NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL");
    }
    // The limits follow from the highest compression that the formats allow: two bits for 16 bytes
    // of attributes, one byte for a triangle or an index.
    const std::size_t max_elements = view.mode == "ATTRIBUTES"
                                         ? view.bytes.size() * 64 / view.stride
                                     : view.mode == "TRIANGLES" ? view.bytes.size() * 3
                                                                : view.bytes.size();
    require(view.count <= max_elements, fmt::format("{} compressed bytes hold {} elements at most",
                                                    view.bytes.size(), max_elements));
}

CompressedView read_view(const SourceDocument& document, const GltfObject& view,
                         const GltfObject& extension) {
    CompressedView result;
    result.bytes = byte_range(document, extension);
    result.stride = extension.integer("byteStride");
    result.count = extension.integer("count");
    result.mode = extension.text("mode", "");
    result.filter = extension.text("filter", "NONE");
    check_shape(extension, result);
    const std::size_t length = view.integer("byteLength");
    if (length != result.count * result.stride) {
        view.fail(fmt::format("byteLength is {}, but {} elements of {} bytes are compressed",
                              length, result.count, result.stride),
                  damaged_data);
    }
    if (view.integer("byteStride", result.stride) != result.stride) {
        view.fail(fmt::format("byteStride must be {}, like that of the compressed elements",
                              result.stride),
                  damaged_data);
    }
    return result;
}

Bytes decode(const GltfObject& extension, const CompressedView& view) {
    Bytes bytes(view.count * view.stride);
    if (bytes.empty()) return bytes;
    const std::uint8_t* data = view.bytes.data();
    const std::size_t size = view.bytes.size();
    const int failure =
        view.mode == "ATTRIBUTES"
            ? meshopt_decodeVertexBuffer(bytes.data(), view.count, view.stride, data, size)
        : view.mode == "TRIANGLES"
            ? meshopt_decodeIndexBuffer(bytes.data(), view.count, view.stride, data, size)
            : meshopt_decodeIndexSequence(bytes.data(), view.count, view.stride, data, size);
    if (failure) {
        extension.fail(fmt::format("its {} bytes cannot be decompressed as {} (error {})", size,
                                   view.mode, failure),
                       damaged_data);
    }
    if (view.filter == "OCTAHEDRAL") {
        meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
    } else if (view.filter == "QUATERNION") {
        meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
    } else if (view.filter == "EXPONENTIAL") {
        meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
    }
    return bytes;
}

}  // namespace

void decode_meshopt_views(SourceDocument& document) {
    const GltfObject root = root_of(document);
    // Views may share their compressed bytes, so their sum is bounded too.
    std::size_t left = 0;
    for (const Bytes& buffer : document.buffers)
        left += 64 * buffer.size();
    for (std::size_t i = 0; i < root.list_size("bufferViews"); ++i) {
        const GltfObject view = root.item("bufferViews", i);
        const auto extensions = view.object("extensions");
        const auto extension = extensions ? extensions->object(extension_name) : std::nullopt;
        if (!extension) continue;
        const CompressedView compressed = read_view(document, view, *extension);
        if (compressed.count * compressed.stride > left) {
            view.fail("the decompressed buffer views are too large for the file", damaged_data);
        }
        left -= compressed.count * compressed.stride;
        document.decoded_views[i] = decode(*extension, compressed);
    }
}

}  // namespace item3d
