// Metal by name. In one picture, brown metal and brown wood differ by little, and a small prior
// lets metallic drift where nobody asked for metal; so it is left alone unless a prompt names one.
#pragma once

#include <string>

namespace item3d {

/// True when a word of the prompt names a metal ("golden", "chrome", ...; English, any case).
bool names_metal(const std::string& prompt);

/// True when exactly one of the prompts does, so that metallic must cross from one end to the
/// other. Near 0 and 1 base colour alone can imitate the other side well enough to hold the
/// optimiser there, and "golden" ends as yellow paint; an edit that begins on its way lets the
/// light decide.
bool crosses_metallic(const std::string& from, const std::string& to);

}  // namespace item3d
