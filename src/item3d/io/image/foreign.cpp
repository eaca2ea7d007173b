#include "item3d/io/image/foreign.h"

#include <string_view>

namespace item3d {

const char* foreign_format(std::span<const std::uint8_t> bytes) {
    using namespace std::string_view_literals;
    struct Kind {
        std::size_t offset;
        std::string_view magic;
        const char* name;
    };
    static constexpr Kind kinds[] = {
        {0, "DDS "sv, "a DDS texture"},
        {0, "\xabKTX 11\xbb"sv, "a KTX 1 texture"},
        {0, "sB\x13\0"sv, "a .basis texture"},
        {0, "8BPS"sv, "a Photoshop document"},
        {4, "ftypavif"sv, "an AVIF"},
        {4, "ftypavis"sv, "an AVIF"},
        {4, "ftypheic"sv, "a HEIC"},
        {4, "ftypmif1"sv, "a HEIF"},
        {0, "\0\0\0\x0cjP  \r\n"sv, "a JPEG 2000"},
        {0, "\xff\x4f\xff\x51"sv, "a JPEG 2000"},
        {0, "\xff\x0a"sv, "a JPEG XL"},
        {0, "\0\0\0\x0cJXL \r\n"sv, "a JPEG XL"},
        {0, "PF\n"sv, "a PFM"},
        {0, "P6"sv, "a PPM"},
        {0, "P5"sv, "a PGM"},
        {0, "<svg"sv, "an SVG"},
        {0, "<?xml"sv, "XML (possibly SVG)"},
        {0, "<!DOCTYPE"sv, "a web page"},
        {0, "<html"sv, "a web page"},
        {0, "%PDF"sv, "a PDF"},
        {0, "gimp xcf"sv, "a GIMP document"},
    };
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (const Kind& kind : kinds) {
        if (text.size() > kind.offset && text.substr(kind.offset).starts_with(kind.magic))
            return kind.name;
    }
    return nullptr;
}

}  // namespace item3d
