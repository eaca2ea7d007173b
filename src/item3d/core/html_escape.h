// Escaping of plain text for HTML.
#pragma once

#include <string>

namespace item3d {

/// Escapes for elements' contents and quoted attributes.
std::string html_escape(const std::string& text);

}  // namespace item3d
