#include "item3d/provenance/image_packet.h"

#include "tests/fuzz/fuzz.h"

/// Writes a packet into an image. If it can be read back, writing it again must change nothing.
ITEM3D_FUZZ_TARGET(image_packet, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const std::span<const std::uint8_t> image(data, size);
        find_packet(image);
        const Bytes written = with_packet(image, "<x:xmpmeta/>");
        if (const auto found = find_packet(written); found && *found == "<x:xmpmeta/>")
            ITEM3D_CHECK(with_packet(written, "<x:xmpmeta/>") == written, "written twice alike");
        image_sha256(image);
    });
}
