// Plain text as a part of a LaTeX document.
#pragma once

#include <string>

namespace item3d {

/// For text outside of mathematics.
std::string latex_escape(const std::string& text);

}  // namespace item3d
