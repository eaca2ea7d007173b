#include "item3d/lighting/adjust.h"
#include "item3d/lighting/description.h"
#include "item3d/lighting/layout.h"
#include "tests/fuzz/fuzz.h"

/// Reads an image as a light. The first two bytes are its size, the third is the layout, and the
/// others are its texels.
ITEM3D_FUZZ_TARGET(light_table, data, size) {
    using namespace item3d;
    if (size < 4) return 0;
    Image image(1 + data[0] % 24, 1 + data[1] % 24, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = static_cast<float>(data[3 + i % (size - 3)]) * 0.1f;
    const auto& names = light_layout_names();
    return fuzz::read_or_refuse([&] {
        const Image light =
            to_equirectangular(image, parse_light_layout(names[data[2] % names.size()]), "light");
        describe_light(light);
        without_lobe(light, brightest_lobe(light));
    });
}
