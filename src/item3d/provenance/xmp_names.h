// Namespaces of XMP, and IPTC source type codes. Internal to provenance.
#pragma once

#include <string_view>

namespace item3d::xmp {

inline constexpr std::string_view rdf = "http://www.w3.org/1999/02/22-rdf-syntax-ns#";
inline constexpr std::string_view meta = "adobe:ns:meta/";
inline constexpr std::string_view dublin_core = "http://purl.org/dc/elements/1.1/";
inline constexpr std::string_view basic = "http://ns.adobe.com/xap/1.0/";
inline constexpr std::string_view rights = "http://ns.adobe.com/xap/1.0/rights/";
inline constexpr std::string_view iptc = "http://iptc.org/std/Iptc4xmpExt/2008-02-29/";
inline constexpr std::string_view item3d = "urn:item3d:provenance:1#";

/// IPTC code (NewsCodes, digitalsourcetype) of media edited by a generative model.
inline constexpr std::string_view edited_by_model =
    "http://cv.iptc.org/newscodes/digitalsourcetype/compositeWithTrainedAlgorithmicMedia";
/// IPTC code of media merged from several camera frames without a generative model.
inline constexpr std::string_view computational_capture =
    "http://cv.iptc.org/newscodes/digitalsourcetype/computationalCapture";

}  // namespace item3d::xmp
