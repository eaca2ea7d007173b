// A picture that an edit gives to a slot of a material, and the file that it becomes.
#pragma once

#include "item3d/core/files.h"
#include "item3d/scene/image.h"
#include "item3d/scene/image_coding.h"

#include <memory>
#include <span>
#include <utility>

namespace item3d {

/// Copies share one picture: materials that share it in the source share one file afterwards.
class EditedTexture {
  public:
    /// None: the slot of the material stays as it was.
    EditedTexture() = default;
    /// Values as they go into files: base colour sRGB-encoded, the others linear. A PNG, of 8 bits
    /// per channel or of 16.
    EditedTexture(Image image, int bits_per_channel = 8);

    explicit operator bool() const { return picture_ != nullptr; }
    const Image& operator*() const { return picture_->image; }
    const Image* operator->() const { return &picture_->image; }

    /// For all copies.
    void set_coding(ImageCoding coding);
    const ImageCoding& coding() const { return picture_->coding; }
    int bits_per_channel() const { return picture_->bits_per_channel; }

    /// The bytes of the file; they are made once.
    const Bytes& encoded() const;
    /// Takes the place of encoded() for all copies: the same picture with metadata.
    void set_encoded(Bytes bytes) { picture_->encoded = std::move(bytes); }

    /// The same for all copies, and for no other.
    const void* identity() const { return picture_.get(); }

  private:
    struct Picture {
        Image image;
        ImageCoding coding;
        int bits_per_channel = 8;
        Bytes encoded;
    };
    std::shared_ptr<Picture> picture_;
};

/// Makes the bytes of all that have none yet, on several threads.
void encode_all(std::span<const EditedTexture> textures);

}  // namespace item3d
