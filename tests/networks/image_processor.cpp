#include "item3d/networks/vision_language/image_processor.h"

#include "item3d/core/error.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

using testing::fixture;
using testing::Golden;

at::Tensor to_planes(const at::Tensor& bytes) {
    return bytes.permute({2, 0, 1}).unsqueeze(0);
}

TEST(ImageProcessor, ResizesByteForByteAsPillow) {
    const Golden golden("image_processor");
    const ImageProcessor processor = ImageProcessor::load(fixture("image_processor"));
    // The images are RGB, RGBA over white, and grey; they are wide and tall.
    for (const std::string name : {"0", "3", "4"})
        EXPECT_TRUE(
            to_planes(processor.resize(golden.in(name))).equal(golden.out("resized_u8." + name)))
            << name;
    EXPECT_TRUE(
        to_planes(resize_bicubic(golden.in("tall"), 32, 32)).equal(golden.out("resized_u8.tall")));
    golden.expect("pixel_values.3", processor.process(golden.in("3")), 1e-5);
}

TEST(ImageProcessor, CropsBeyondTheImage) {
    const Golden golden("image_processor");
    const auto processor = ImageProcessor::load(fixture("image_processor") / "padcrop");
    golden.expect("pixel_values.padcrop.1", processor.process(golden.in("1")), 1e-5);
}

TEST(ImageProcessor, TheDifferentiableWayGivesTheSameButForRounding) {
    const Golden golden("image_processor");
    const ImageProcessor processor = ImageProcessor::load(fixture("image_processor"));
    at::Tensor image = to_planes(golden.in("0")).to(at::kFloat) / 255;
    image.requires_grad_();
    const at::Tensor values = processor.process_differentiably(image);
    // The processor rounds to bytes twice, and values are divided by a deviation of 0.26.
    EXPECT_LT(testing::largest_difference(values.detach(), processor.process(golden.in("0"))),
              1.5 / 255 / 0.26);

    // The weights of a resize sum to one, so a brighter image makes all values larger in
    // proportion.
    values.sum().backward();
    const double expected = 3.0 * 32 * 32 / ((0.26862954 + 0.26130258 + 0.27577711) / 3);
    EXPECT_GT(image.grad().sum().item<double>(), 0.9 * expected);
}

TEST(ImageProcessor, KeepsAImageOfTheRightSize) {
    const at::Tensor bytes = at::randint(256, {5, 7, 3}, at::kByte);
    EXPECT_TRUE(resize_bicubic(bytes, 5, 7).equal(bytes));
}

TEST(ImageProcessor, ReadsOldAndNewSizes) {
    const auto read = [](const nlohmann::json& json) {
        return ImageProcessorConfig::from_config(Config(json, "preprocessor_config.json"));
    };
    const auto old = read({{"size", 30}, {"crop_size", 20}});
    EXPECT_EQ(old.shortest_edge, 30);
    EXPECT_EQ(old.crop_width, 20);
    EXPECT_TRUE(old.center_crop);
    const auto exact = read({{"size", {{"height", 3}, {"width", 4}}}});
    EXPECT_EQ(exact.height, 3);
    EXPECT_FALSE(exact.center_crop);
    EXPECT_THROW(read({{"resample", 0}}), InputError);
    EXPECT_THROW(read({{"do_resize", false}}), InputError);
    EXPECT_THROW(read({{"size", {{"height", 3}}}}), InputError);
    EXPECT_THROW(read({{"size", 1000000}}), InputError);
    EXPECT_THROW(read({{"image_std", {0, 0, 0}}}), InputError);
    EXPECT_THROW(read({{"image_mean", {0.5}}}), InputError);
}

}  // namespace
}  // namespace item3d
