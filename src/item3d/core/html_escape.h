// Plain text as a part of an HTML page.
#pragma once

#include <string>

namespace item3d {

/// For elements' contents and for attributes within quotes.
std::string html_escape(const std::string& text);

}  // namespace item3d
