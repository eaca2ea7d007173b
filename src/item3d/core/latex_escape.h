// Escaping of plain text for LaTeX.
#pragma once

#include <string>

namespace item3d {

/// Escapes text outside of mathematics.
std::string latex_escape(const std::string& text);

}  // namespace item3d
