#include "apps/parity/parity.h"
#include "item3d/core/error.h"
#include "item3d/io/load.h"
#include "item3d/networks/vision_language/image_processor.h"
#include "item3d/render/image_tensor.h"

namespace item3d::parity {
namespace {

/// Reads a recorded image as bytes [H, W, C].
at::Tensor read_bytes_of(const std::filesystem::path& path) {
    return (to_tensor(load_image(path)) * 255).round().to(at::kByte);
}

}  // namespace

std::vector<at::Tensor> compare_image_processors(Case& golden) {
    const Config meta = golden.meta();
    const auto names = meta.texts("images", {});
    if (!meta.has("processors")) meta.fail("processors", "an object");
    std::vector<at::Tensor> images;  // outputs of the first processor, which has no name
    for (const auto& [tag, chosen] : meta.json().at("processors").items()) {
        const ImageProcessor processor = ImageProcessor::load(golden.folder() / tag);
        for (std::size_t i = 0; i < names.size(); ++i) {
            const std::string suffix = (tag.empty() ? "" : tag + ".") + std::to_string(i);
            if (!golden.has("out.pixel_values." + suffix)) continue;
            const at::Tensor bytes = read_bytes_of(golden.folder() / "images" / names[i]);
            const at::Tensor pixel_values = processor.process(bytes);
            golden.compare("pixel_values." + suffix, pixel_values, within::scheduler_step);
            golden.compare("resized_u8." + suffix,
                           processor.resize(bytes).permute({2, 0, 1}).unsqueeze(0), within::exact);
            if (tag.empty()) images.push_back(pixel_values);
        }
    }
    return images;
}

}  // namespace item3d::parity
