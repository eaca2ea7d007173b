#include "item3d/provenance/image_packet.h"

#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/provenance/ktx2_packet.h"
#include "item3d/provenance/xmp.h"

#include <webp/mux.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

namespace item3d {
namespace {

using Span = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 8> png_signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::string_view png_keyword{"XML:com.adobe.xmp\0", 18};
constexpr std::string_view jpeg_header{"http://ns.adobe.com/xap/1.0/\0", 29};
constexpr std::string_view jpeg_extension{"http://ns.adobe.com/xmp/extension/\0", 35};
constexpr std::size_t largest_jpeg_packet = 65533 - jpeg_header.size();

bool begins_with(Span bytes, std::string_view text) {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

std::uint32_t big_endian(Span bytes) {
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 |
           std::uint32_t{bytes[2]} << 8 | bytes[3];
}

std::uint32_t little_endian(Span bytes) {
    return std::uint32_t{bytes[3]} << 24 | std::uint32_t{bytes[2]} << 16 |
           std::uint32_t{bytes[1]} << 8 | bytes[0];
}

/// A segment of an image file.
struct Piece {
    Span bytes;
    bool is_packet = false;
    /// True for parts that depend on the other parts: WebP's file header and its VP8X chunk, which
    /// lists the file's features. A packet changes both.
    bool is_derived = false;
    bool is_header = false;  ///< true for the header, after which a packet is inserted
};

/// Segments of a file; empty if the file is damaged.
using Pieces = std::vector<Piece>;

Pieces png_pieces(Span image) {
    Pieces pieces{{image.first(png_signature.size()), false, false, true}};
    std::size_t at = png_signature.size();
    while (at + 12 <= image.size()) {
        const std::size_t size = big_endian(image.subspan(at));
        if (size > image.size() - at - 12) return {};
        const Span chunk = image.subspan(at, size + 12);
        const bool is_packet = begins_with(chunk.subspan(4), "iTXt") &&
                               begins_with(chunk.subspan(8, size), png_keyword);
        pieces.push_back({chunk, is_packet, false, begins_with(chunk.subspan(4), "IHDR")});
        at += size + 12;
    }
    if (at < image.size()) pieces.push_back({image.subspan(at)});
    return pieces;
}

/// Splits a JPEG into its segments. The scan and everything after it are one piece.
Pieces jpeg_pieces(Span image) {
    Pieces pieces{{image.first(2), false, false, true}};
    std::size_t at = 2;
    while (at + 4 <= image.size() && image[at] == 0xff) {
        const std::uint8_t marker = image[at + 1];
        if (marker == 0xda || marker == 0xd9) break;
        const std::size_t size = std::size_t{image[at + 2]} << 8 | image[at + 3];
        if (size < 2 || size + 2 > image.size() - at) return {};
        const Span segment = image.subspan(at, size + 2);
        const bool is_app1 = marker == 0xe1;
        const bool is_packet = is_app1 && (begins_with(segment.subspan(4), jpeg_header) ||
                                           begins_with(segment.subspan(4), jpeg_extension));
        const bool is_exif = is_app1 && begins_with(segment.subspan(4), "Exif");
        pieces.push_back({segment, is_packet, false, marker == 0xe0 || is_exif});
        at += size + 2;
    }
    pieces.push_back({image.subspan(at)});
    return pieces;
}

Pieces webp_pieces(Span image) {
    Pieces pieces{{image.first(12), false, true, false}};
    std::size_t at = 12;
    while (at + 8 <= image.size()) {
        const std::size_t size = little_endian(image.subspan(at + 4));
        const std::size_t padded = size + size % 2;
        if (size > image.size() - at - 8) return {};
        const Span chunk = image.subspan(at, std::min(8 + padded, image.size() - at));
        pieces.push_back(
            {chunk.first(8 + size), begins_with(chunk, "XMP "), begins_with(chunk, "VP8X"), false});
        at += chunk.size();
    }
    return pieces;
}

Pieces pieces_of(Span image) {
    switch (packet_container(image)) {
        case PacketContainer::png:
            return png_pieces(image);
        case PacketContainer::jpeg:
            return jpeg_pieces(image);
        case PacketContainer::webp:
            return webp_pieces(image);
        case PacketContainer::ktx2:
        case PacketContainer::none:
            break;
    }
    return {};
}

std::string to_text(Span bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::optional<std::string> inflated(Span bytes) {
    std::string text(largest_packet + 1, '\0');
    auto size = static_cast<uLongf>(text.size());
    if (uncompress(reinterpret_cast<Bytef*>(text.data()), &size, bytes.data(),
                   static_cast<uLong>(bytes.size())) != Z_OK)
        return std::nullopt;
    text.resize(size);
    return text;
}

/// Returns the text of an iTXt chunk. The text follows the keyword, the compression flag and
/// method, the language and the translated keyword.
std::optional<std::string> png_packet(Span chunk) {
    Span rest = chunk.subspan(8, chunk.size() - 12).subspan(png_keyword.size());
    if (rest.size() < 2) return std::nullopt;
    const bool is_compressed = rest[0] != 0;
    rest = rest.subspan(2);
    for (int part = 0; part < 2; ++part) {
        const auto end = std::find(rest.begin(), rest.end(), std::uint8_t{0});
        if (end == rest.end()) return std::nullopt;
        rest = rest.subspan(static_cast<std::size_t>(end - rest.begin()) + 1);
    }
    return is_compressed ? inflated(rest) : to_text(rest);
}

void put_big_endian(Bytes& out, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8)
        out.push_back(static_cast<std::uint8_t>(value >> shift & 255));
}

void put_text(Bytes& out, std::string_view text) {
    out.insert(out.end(), text.begin(), text.end());
}

Bytes png_chunk(const std::string& packet) {
    Bytes body;
    put_text(body, "iTXt");
    put_text(body, png_keyword);
    body.insert(body.end(), 4, 0);  // not compressed, no language, no translated keyword
    put_text(body, packet);
    Bytes chunk;
    put_big_endian(chunk, static_cast<std::uint32_t>(body.size() - 4));
    chunk.insert(chunk.end(), body.begin(), body.end());
    put_big_endian(
        chunk, static_cast<std::uint32_t>(crc32(0, body.data(), static_cast<uInt>(body.size()))));
    return chunk;
}

Bytes jpeg_segment(const std::string& packet) {
    const std::size_t size = 2 + jpeg_header.size() + packet.size();
    Bytes segment{0xff, 0xe1, static_cast<std::uint8_t>(size >> 8),
                  static_cast<std::uint8_t>(size & 255)};
    put_text(segment, jpeg_header);
    put_text(segment, packet);
    return segment;
}

/// Joins the pieces that are not packets, and inserts `packet` after the header.
Bytes joined(const Pieces& pieces, const Bytes& packet) {
    std::size_t header = 0;
    while (header < pieces.size() && (pieces[header].is_header || pieces[header].is_packet))
        ++header;
    Bytes out;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (i == header) out.insert(out.end(), packet.begin(), packet.end());
        if (pieces[i].is_packet) continue;
        out.insert(out.end(), pieces[i].bytes.begin(), pieces[i].bytes.end());
    }
    return out;
}

Bytes webp_with_packet(Span image, const std::string& packet) {
    const WebPData data{image.data(), image.size()};
    const std::unique_ptr<WebPMux, decltype(&WebPMuxDelete)> mux(WebPMuxCreate(&data, 0),
                                                                 &WebPMuxDelete);
    const WebPData text{reinterpret_cast<const std::uint8_t*>(packet.data()), packet.size()};
    WebPData written{};
    const bool is_written = mux && WebPMuxSetChunk(mux.get(), "XMP ", &text, 0) == WEBP_MUX_OK &&
                            WebPMuxAssemble(mux.get(), &written) == WEBP_MUX_OK;
    if (!is_written) return {image.begin(), image.end()};
    Bytes bytes(written.bytes, written.bytes + written.size);
    WebPDataClear(&written);
    return bytes;
}

}  // namespace

PacketContainer packet_container(Span image) {
    if (image.size() >= png_signature.size() &&
        std::equal(png_signature.begin(), png_signature.end(), image.begin()))
        return PacketContainer::png;
    if (begins_with(image, "\xff\xd8\xff")) return PacketContainer::jpeg;
    if (image.size() >= 12 && begins_with(image, "RIFF") && begins_with(image.subspan(8), "WEBP"))
        return PacketContainer::webp;
    return is_ktx2(image) ? PacketContainer::ktx2 : PacketContainer::none;
}

std::optional<std::string> find_packet(Span image) {
    const PacketContainer container = packet_container(image);
    if (container == PacketContainer::ktx2) return find_ktx2_packet(image);
    for (const Piece& piece : pieces_of(image)) {
        if (!piece.is_packet) continue;
        if (container == PacketContainer::png) return png_packet(piece.bytes);
        if (container == PacketContainer::webp) return to_text(piece.bytes.subspan(8));
        if (begins_with(piece.bytes.subspan(4), jpeg_header))
            return to_text(piece.bytes.subspan(4 + jpeg_header.size()));
    }
    return std::nullopt;
}

Bytes with_packet(Span image, const std::string& packet) {
    const PacketContainer container = packet_container(image);
    if (container == PacketContainer::webp) return webp_with_packet(image, packet);
    if (container == PacketContainer::ktx2) {
        Bytes written = ktx2_with_packet(image, packet);
        return written.empty() ? Bytes(image.begin(), image.end()) : written;
    }
    const Pieces pieces = pieces_of(image);
    const bool is_too_large =
        container == PacketContainer::jpeg && packet.size() > largest_jpeg_packet;
    if (pieces.empty() || is_too_large) return {image.begin(), image.end()};
    return joined(pieces,
                  container == PacketContainer::png ? png_chunk(packet) : jpeg_segment(packet));
}

std::string image_sha256(Span image) {
    if (const Bytes ktx2 = ktx2_with_packet(image, std::nullopt); !ktx2.empty())
        return sha256(ktx2);
    const Pieces pieces = pieces_of(image);
    if (pieces.empty()) return sha256(image);
    Digest digest(DigestKind::sha256, image.size());
    for (const Piece& piece : pieces)
        if (!piece.is_packet && !piece.is_derived) digest.update(piece.bytes);
    return digest.finish();
}

}  // namespace item3d
