// An image that an edit assigns to a texture slot of a material, and its encoded file.
#pragma once

#include "item3d/core/files.h"
#include "item3d/scene/image.h"
#include "item3d/scene/image_coding.h"

#include <memory>
#include <span>
#include <utility>

namespace item3d {

/// Copies share one image, so materials that share an image in the source model share one file in
/// the edited model.
class EditedTexture {
  public:
    /// Makes a texture without an image, which leaves the material's slot unchanged.
    EditedTexture() = default;
    /// Takes values as files store them: base colour is sRGB-encoded, all other values are linear.
    /// Without set_coding(), the file is a PNG of 8 or 16 bits per channel.
    EditedTexture(Image image, int bits_per_channel = 8);

    explicit operator bool() const { return image_ != nullptr; }
    const Image& operator*() const { return image_->image; }
    const Image* operator->() const { return &image_->image; }

    /// Sets the coding of this texture and of all its copies.
    void set_coding(ImageCoding coding);
    const ImageCoding& coding() const { return image_->coding; }
    int bits_per_channel() const { return image_->bits_per_channel; }

    /// Returns the bytes of the file; encodes on first use.
    const Bytes& encoded() const;
    /// Replaces the file of all copies by a file of the same image with metadata.
    void set_encoded(Bytes bytes) { image_->encoded = std::move(bytes); }

    /// Returns a pointer that is equal for copies of one texture, and different for other textures.
    const void* identity() const { return image_.get(); }

  private:
    struct SharedImage {
        Image image;
        ImageCoding coding;
        int bits_per_channel = 8;
        Bytes encoded;
    };
    std::shared_ptr<SharedImage> image_;
};

/// Encodes all images that are not encoded yet, on several threads.
void encode_all(std::span<const EditedTexture> textures);

}  // namespace item3d
