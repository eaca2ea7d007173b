// HTML template of the gallery: markup, style and script with placeholders.
#pragma once

#include <string_view>

namespace item3d {

/// The HTML page. gallery.cpp replaces its placeholders {{TITLE}} and {{HEADING}} by text, and
/// {{CARDS}} by JSON.
extern const std::string_view gallery_page;

}  // namespace item3d
