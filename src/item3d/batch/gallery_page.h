// HTML template of the gallery: markup, style and script with placeholders.
#pragma once

#include <string_view>

namespace item3d {

/// Page with the placeholders {{TITLE}}, {{HEADING}} (text) and {{CARDS}} (JSON) that gallery.cpp
/// replaces.
extern const std::string_view gallery_page;

}  // namespace item3d
