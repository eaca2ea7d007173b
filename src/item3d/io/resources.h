// Files and data that a model refers to, without ever leaving its folder. Internal to io.
#pragma once

#include "item3d/core/files.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// Whether a file that was found by another spelling of its name is told of.
enum class Forgiving { with_note, silently };

/// The regular file `relative` (either separator) in `folder`: that very one, or what
/// find_file_below() finds for it or for one of its other_spellings(). What lies outside of the
/// folder (absolute, "..", links) is an InputError that names `subject`, as is a missing file.
std::filesystem::path resolve_in_folder(const std::filesystem::path& folder,
                                        const std::filesystem::path& relative,
                                        const std::string& subject,
                                        Forgiving forgiving = Forgiving::with_note);

/// The same for a URI of a glTF. Other schemes than a plain relative reference ("http:", ...) are
/// an InputError: nothing is fetched; of "file:" and drive letters the file's name alone is looked
/// for.
std::filesystem::path resolve_uri(const std::filesystem::path& folder, std::string_view uri,
                                  const std::string& subject,
                                  Forgiving forgiving = Forgiving::with_note);

/// The regular file that a text format names, with '/' or '\\' as separators: relative to the first
/// of `folders` that has it, else by its bare name (exporters write paths of the machine that they
/// ran on). Nothing outside `root` is read, but for what find_allowed() finds. Throws the
/// InputError of the first try.
std::filesystem::path resolve_beside(const std::filesystem::path& root,
                                     const std::vector<std::filesystem::path>& folders,
                                     const std::string& name, const std::string& subject,
                                     const std::vector<std::filesystem::path>& allowed = {});

/// A file in one of the folders that the user allows (LoadOptions::texture_folders): what `folder`
/// / `name` is, where that lies in one of them, else the longest end of `name` that one of them
/// has. No value: there is none.
std::optional<std::filesystem::path> find_allowed(const std::vector<std::filesystem::path>& allowed,
                                                  const std::filesystem::path& folder,
                                                  const std::filesystem::path& name,
                                                  const std::string& subject);

bool is_data_uri(std::string_view uri);
/// The bytes of "data:...;base64,..." or "data:,...". Throws InputError.
Bytes decode_data_uri(std::string_view uri, const std::string& subject);

std::string path_to_uri(const std::filesystem::path& relative);

std::string encode_base64(std::span<const std::uint8_t> bytes);

}  // namespace item3d
