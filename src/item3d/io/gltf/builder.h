// Appends buffer views, accessors and images to a glTF's JSON. Internal to io.
#pragma once

#include "item3d/io/edited_texture.h"
#include "item3d/io/gltf/accessors.h"
#include "item3d/scene/image_coding.h"

#include <map>
#include <span>
#include <utility>

namespace item3d {

/// What new data becomes: one buffer that grows (its byteLength is set by finish()), and images in
/// it or in files beside the document.
class GltfBuilder {
  public:
    /// buffer: index of the buffer that grows, with `binary` in it already; images_in_files: give
    /// new images a URI (stem_NAME.EXTENSION) instead of a buffer view.
    GltfBuilder(Json& json, std::size_t buffer, Bytes binary, bool images_in_files,
                std::string stem);

    std::size_t add_view(std::span<const std::uint8_t> bytes, int target = 0,
                         std::size_t stride = 0);
    /// `elements` packed as described by `shape` (its bytes are not used); padded to four bytes
    /// each. with_bounds writes min and max.
    std::size_t add_vertices(const Accessor& shape, const Bytes& elements, bool with_bounds);
    std::size_t add_floats(std::span<const float> values, std::size_t components,
                           bool with_bounds = false);
    std::size_t add_indices(std::span<const std::uint32_t> indices, std::size_t vertex_count);
    /// Adds a picture as an image; returns its index.
    std::size_t add_image(const Bytes& bytes, ImageEncoding encoding, const std::string& name);
    /// Adds a picture as image and texture; sampler -1: none. Returns the texture's index. Lists of
    /// extensions are list_texture_extensions()' work.
    std::size_t add_texture(const Bytes& bytes, ImageEncoding encoding, const std::string& name,
                            int sampler);
    /// Adds a picture once for each sampler: further calls return the texture of the first.
    std::size_t add_texture(const EditedTexture& picture, const std::string& name, int sampler);
    /// Turns an existing image into one that lies in the buffer.
    void embed_image(Json& image, const Bytes& bytes, const std::string& mime_type);

    /// The buffer with less in it; whoever calls has moved the views.
    void replace_binary(Bytes binary);

    /// Sets byteLength of the buffer (adding it when it is new and not empty).
    void finish();

    Json& json() { return json_; }
    std::size_t buffer() const { return buffer_; }
    const Bytes& binary() const { return binary_; }
    /// Files to be written beside the document, by URI-decoded relative name.
    const std::map<std::string, Bytes>& files() const { return files_; }
    /// A name that no image or buffer of the document refers to.
    std::string unused_file_name(const std::string& stem, const std::string& extension) const;

  private:
    Json& json_;
    std::size_t buffer_;
    Bytes binary_;
    std::size_t size_before_;
    bool is_cut_ = false;
    bool images_in_files_;
    std::string stem_;
    std::map<std::string, Bytes> files_;
    std::map<std::pair<const void*, int>, std::size_t> edited_;  ///< by identity and sampler
};

/// Adds `value` to the list `key`, which is made when it is missing; returns its index.
std::size_t append(Json& object, const char* key, Json value);

}  // namespace item3d
