#include "item3d/io/image/stb.h"

#include "item3d/io/image/formats.h"
#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(stb, data, size) {
    return item3d::fuzz::read_or_refuse([&] {
        switch (item3d::detect_image_format({data, size})) {
            case item3d::ImageFormat::bmp:
            case item3d::ImageFormat::tga:
            case item3d::ImageFormat::gif:
                item3d::decode_image({data, size}, "input");
                break;
            default:
                break;
        }
    });
}
