// Typed arrays (accessors) in glTF buffers. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

#include <glm/glm.hpp>

namespace item3d {

/// glTF's codes of component types.
enum class ComponentType : int {
    i8 = 5120,
    u8 = 5121,
    i16 = 5122,
    u16 = 5123,
    u32 = 5125,
    f32 = 5126
};

std::size_t component_size(ComponentType type);

/// The elements of an accessor, tightly packed, with sparse substitutions applied.
struct Accessor {
    ComponentType component_type = ComponentType::f32;
    std::string type;              ///< "SCALAR", "VEC3", "MAT4", ...
    std::size_t components = 1;    ///< number of components in an element
    std::size_t element_size = 4;  ///< bytes, with the padding of small matrices
    std::size_t padded_rows = 0;   ///< rows of a matrix whose columns may be padded; else 0
    std::size_t count = 0;
    bool normalized = false;
    Bytes bytes;  ///< count * element_size

    /// Returns the stored value.
    double raw(std::size_t element, std::size_t component) const;
    /// Returns the value with normalised integers mapped to [0, 1] or [-1, 1].
    float value(std::size_t element, std::size_t component) const;
};

/// Reads an accessor's properties without its bytes. Throws InputError.
Accessor accessor_shape(const SourceDocument& document, std::size_t index);

/// Reads an accessor. Checks all sizes against the buffers before allocating. Throws InputError.
Accessor read_accessor(const SourceDocument& document, std::size_t index);

/// Reads an accessor with min_components to max_components components.
Accessor read_vectors(const SourceDocument& document, std::size_t index, std::size_t min_components,
                      std::size_t max_components);
std::vector<std::uint32_t> read_indices(const SourceDocument& document, std::size_t index);

}  // namespace item3d
