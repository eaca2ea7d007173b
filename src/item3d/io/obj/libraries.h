// The material libraries of an OBJ file. Internal to io.
#pragma once

#include "item3d/io/obj/mtl.h"
#include "item3d/io/obj/parse.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Reads the libraries that mtllib statements name, and looks materials up by name. Warns of
/// missing libraries. If all are missing, reads the .mtl file with the name of the OBJ file, if
/// there is one.
class ObjLibraries {
  public:
    ObjLibraries(const std::filesystem::path& path, const ObjFile& file);

    /// Returns the material that a usemtl statement names, ignoring comments and case if there is
    /// no exact match. Returns null if no library has the material.
    const MtlMaterial* find(const std::string& name) const;

  private:
    void read(const std::string& name);
    void read_statement(const std::string& statement, std::vector<std::string>& problems);
    /// Reads the .mtl file with the name of the OBJ file, if there is one and a face uses a
    /// material. Returns the file's name if it was read, else an empty string.
    std::string read_own_name(const ObjFile& file);

    std::filesystem::path path_;
    std::vector<std::string> names_;  ///< names in usemtl, for detecting the libraries' encoding
    std::map<std::string, MtlMaterial> materials_;
    bool any_was_read_ = false;
};

}  // namespace item3d
