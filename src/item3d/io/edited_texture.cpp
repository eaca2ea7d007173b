#include "item3d/io/edited_texture.h"

#include "item3d/io/texture_format.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <map>
#include <thread>
#include <utility>
#include <vector>

namespace item3d {

EditedTexture::EditedTexture(Image image, int bits_per_channel)
    : image_(std::make_shared<SharedImage>()) {
    image_->image = std::move(image);
    image_->bits_per_channel = bits_per_channel;
}

void EditedTexture::set_coding(ImageCoding coding) {
    if (coding == image_->coding) return;
    image_->coding = coding;
    image_->encoded.clear();
}

const Bytes& EditedTexture::encoded() const {
    if (image_->encoded.empty())
        image_->encoded = encode_texture(image_->image, image_->coding, image_->bits_per_channel);
    return image_->encoded;
}

void encode_all(std::span<const EditedTexture> textures) {
    std::map<const void*, const EditedTexture*> unique;
    for (const EditedTexture& texture : textures) {
        if (texture) unique.emplace(texture.identity(), &texture);
    }
    std::vector<const EditedTexture*> waiting;
    for (const auto& [identity, texture] : unique)
        waiting.push_back(texture);
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
        for (std::size_t i = next++; i < waiting.size(); i = next++)
            (void)waiting[i]->encoded();
    };
    std::vector<std::future<void>> workers;
    const std::size_t threads =
        std::min<std::size_t>(waiting.size(), std::max(1u, std::thread::hardware_concurrency()));
    for (std::size_t t = 1; t < threads; ++t)
        workers.push_back(std::async(std::launch::async, work));
    work();
    for (std::future<void>& worker : workers)
        worker.get();
}

}  // namespace item3d
