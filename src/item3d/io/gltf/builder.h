// A builder that appends buffer views, accessors and images to a glTF's JSON. Internal to io.
#pragma once

#include "item3d/io/edited_texture.h"
#include "item3d/io/gltf/accessors.h"
#include "item3d/scene/image_coding.h"

#include <map>
#include <span>
#include <utility>

namespace item3d {

/// Destination of new data: one growing buffer (finish() sets its byteLength), and images in it or
/// in files beside the document.
class GltfBuilder {
  public:
    /// buffer: index of the growing buffer, which already contains `binary`. images_in_files: new
    /// images get a URI (stem_NAME.EXTENSION) instead of a buffer view.
    GltfBuilder(Json& json, std::size_t buffer, Bytes binary, bool images_in_files,
                std::string stem);

    std::size_t add_view(std::span<const std::uint8_t> bytes, int target = 0,
                         std::size_t stride = 0);
    /// Adds packed `elements` described by `shape` (whose bytes are ignored), each padded to four
    /// bytes. with_bounds: writes min and max.
    std::size_t add_vertices(const Accessor& shape, const Bytes& elements, bool with_bounds);
    std::size_t add_floats(std::span<const float> values, std::size_t components,
                           bool with_bounds = false);
    std::size_t add_indices(std::span<const std::uint32_t> indices, std::size_t vertex_count);
    /// Adds an image; returns its index.
    std::size_t add_image(const Bytes& bytes, ImageEncoding encoding, const std::string& name);
    /// Adds an image and a texture; a sampler of -1 means none. Returns the texture's index. Does
    /// not update the list of used extensions, see list_texture_extensions().
    std::size_t add_texture(const Bytes& bytes, ImageEncoding encoding, const std::string& name,
                            int sampler);
    /// Adds a texture of this image and sampler; returns its index. Further calls with the same
    /// image and sampler return the same index.
    std::size_t add_texture(const EditedTexture& image, const std::string& name, int sampler);
    /// Moves an existing image into the buffer.
    void embed_image(Json& image, const Bytes& bytes, const std::string& mime_type);

    /// Replaces the buffer by a smaller one; the caller must have adjusted the views.
    void replace_binary(Bytes binary);

    /// Sets the buffer's byteLength. First adds the buffer to the document if it is new and not
    /// empty.
    void finish();

    Json& json() { return json_; }
    std::size_t buffer() const { return buffer_; }
    const Bytes& binary() const { return binary_; }
    /// Files to write beside the document, by URI-decoded relative name.
    const std::map<std::string, Bytes>& files() const { return files_; }
    /// Returns a name that no image or buffer of the document uses.
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

/// Appends `value` to the list `key`, which it creates if missing; returns the index.
std::size_t append(Json& object, const char* key, Json value);

}  // namespace item3d
