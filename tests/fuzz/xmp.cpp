#include "item3d/provenance/xmp.h"

#include "tests/fuzz/fuzz.h"

#include <nlohmann/json.hpp>

ITEM3D_FUZZ_TARGET(xmp, data, size) {
    using namespace item3d;
    const std::string packet = fuzz::as_text(data, size);
    return fuzz::read_or_refuse([&] {
        read_xmp(packet);
        read_xmp(xmp_with_claim(packet, {{"edits", nlohmann::json::array()}}));
    });
}
