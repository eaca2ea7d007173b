// The gallery's markup, style and script, with marks for what is filled in.
#pragma once

#include <string_view>

namespace item3d {

/// {{TITLE}}, {{HEADING}} (text) and {{CARDS}} (JSON) stand for what gallery.cpp puts there.
extern const std::string_view gallery_page;

}  // namespace item3d
