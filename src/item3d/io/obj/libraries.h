// The material libraries of an OBJ file. Internal to io.
#pragma once

#include "item3d/io/obj/mtl.h"
#include "item3d/io/obj/parse.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Reads the libraries of mtllib, and looks materials up by name. Warns of missing libraries; where
/// all are missing, reads a library with the name of the OBJ file itself, if any.
class ObjLibraries {
  public:
    ObjLibraries(const std::filesystem::path& path, const ObjFile& file);

    /// Returns the material of a usemtl, ignoring comments and case if there is no exact match.
    /// Null when no library has it.
    const MtlMaterial* find(const std::string& name) const;

  private:
    void read(const std::string& name);
    void read_statement(const std::string& statement, std::vector<std::string>& problems);
    /// Returns the name of the library that was read, or an empty string.
    std::string read_own_name(const ObjFile& file);

    std::filesystem::path path_;
    std::vector<std::string> names_;  ///< names in usemtl, for detecting the libraries' encoding
    std::map<std::string, MtlMaterial> materials_;
    bool any_was_read_ = false;
};

}  // namespace item3d
