// Access to files and data that a model refers to, restricted to its folder. Internal to io.
#pragma once

#include "item3d/core/files.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// Policy for a file that is found only by another spelling of its name: accept it with a note or
/// silently.
enum class Forgiving { with_note, silently };

/// Returns the regular file `relative` (with either separator) in `folder`: an exact match, or the
/// result of find_file_below() for it or for one of its other_spellings(). Throws InputError that
/// names `subject` for paths outside of the folder (absolute, "..", links) and for a missing file.
std::filesystem::path resolve_in_folder(const std::filesystem::path& folder,
                                        const std::filesystem::path& relative,
                                        const std::string& subject,
                                        Forgiving forgiving = Forgiving::with_note);

/// Resolves a URI of a glTF as resolve_in_folder() does a path. Throws InputError for schemes other
/// than a plain relative reference ("http:", ...): nothing is downloaded. For URIs with "file:" or
/// a drive letter, searches only for the bare file name.
std::filesystem::path resolve_uri(const std::filesystem::path& folder, std::string_view uri,
                                  const std::string& subject,
                                  Forgiving forgiving = Forgiving::with_note);

/// Returns the regular file with a name from an OBJ or MTL file, whose separators are '/' or '\\'.
/// Takes the file from the first of `folders` that contains `name`, or else from the first that
/// contains its bare file name, because exporters write paths of their own machine. Finds nothing
/// outside `root` except by find_allowed(). If all attempts fail, throws the InputError of the
/// first one.
std::filesystem::path resolve_beside(const std::filesystem::path& root,
                                     const std::vector<std::filesystem::path>& folders,
                                     const std::string& name, const std::string& subject,
                                     const std::vector<std::filesystem::path>& allowed = {});

/// Returns a file in one of the user's allowed folders (LoadOptions::texture_folders); no value if
/// none is found. In each allowed folder, tries these paths in turn: `folder` / `name`, if it lies
/// in the allowed folder; each suffix of `name`, the longest first; the bare file name in
/// subfolders.
std::optional<std::filesystem::path> find_allowed(const std::vector<std::filesystem::path>& allowed,
                                                  const std::filesystem::path& folder,
                                                  const std::filesystem::path& name,
                                                  const std::string& subject);

bool is_data_uri(std::string_view uri);
/// Returns the bytes of a URI "data:...;base64,..." or "data:,...". Throws InputError for a damaged
/// URI.
Bytes decode_data_uri(std::string_view uri, const std::string& subject);

std::string path_to_uri(const std::filesystem::path& relative);

std::string encode_base64(std::span<const std::uint8_t> bytes);

}  // namespace item3d
