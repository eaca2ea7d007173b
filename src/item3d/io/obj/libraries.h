// The material libraries that an OBJ file names. Internal to io.
#pragma once

#include "item3d/io/obj/mtl.h"
#include "item3d/io/obj/parse.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// What mtllib says, read and looked up by name. A library that is not there is a warning; where
/// none is, and one has the name of the OBJ file itself, that one is read.
class ObjLibraries {
  public:
    ObjLibraries(const std::filesystem::path& path, const ObjFile& file);

    /// The material of a usemtl: of that name, or of that name but for a remark or the case of
    /// letters. Null when no library has it.
    const MtlMaterial* find(const std::string& name) const;

  private:
    void read(const std::string& name);
    void read_statement(const std::string& statement, std::vector<std::string>& problems);
    /// Returns the name of what was read, or nothing.
    std::string read_own_name(const ObjFile& file);

    std::filesystem::path path_;
    std::vector<std::string> names_;  ///< of usemtl, for the libraries' encoding
    std::map<std::string, MtlMaterial> materials_;
    bool any_was_read_ = false;
};

}  // namespace item3d
