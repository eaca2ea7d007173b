// Escaping of plain text for HTML.
#pragma once

#include <string>

namespace item3d {

/// Returns the text escaped for the content of an element or for a quoted attribute.
std::string html_escape(const std::string& text);

}  // namespace item3d
