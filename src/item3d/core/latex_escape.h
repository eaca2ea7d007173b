// Escaping of plain text for LaTeX.
#pragma once

#include <string>

namespace item3d {

/// Returns the text escaped for use outside of formulas.
std::string latex_escape(const std::string& text);

}  // namespace item3d
