#include "item3d/io/obj/read.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/io/obj/materials.h"
#include "item3d/io/obj/triangulate.h"
#include "item3d/io/resources.h"
#include "item3d/io/text.h"
#include "item3d/scene/normals.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

namespace item3d {
namespace fs = std::filesystem;
namespace {

/// Indices from 0 into the file's lists, -1: not given.
struct Corner {
    std::int32_t position = -1;
    std::int32_t uv = -1;
    std::int32_t normal = -1;
    bool operator==(const Corner&) const = default;
};

struct CornerHash {
    std::size_t operator()(const Corner& c) const {
        const auto high = static_cast<std::uint64_t>(static_cast<std::uint32_t>(c.position)) << 32;
        return mix_bits(mix_bits(high | static_cast<std::uint32_t>(c.uv)) ^
                        static_cast<std::uint32_t>(c.normal));
    }
};

struct Face {
    std::size_t first_corner;
    std::uint32_t corner_count;
    int material;  ///< into ObjReader::material_names
    int line;
};

class ObjReader {
  public:
    ObjReader(const fs::path& path, const Bytes& bytes)
        : path_(path),
          text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
          lines_(text_) {}

    Model read();

  private:
    [[noreturn]] void fail(int line, const std::string& problem,
                           const std::string& hint = "") const {
        throw InputError(fmt::format("{}:{}", path_.string(), line), problem, hint);
    }
    void read_vertex(std::string_view rest);
    void read_face(std::string_view rest);
    std::int32_t read_index(std::string_view text, std::size_t count) const;
    Corner read_corner(std::string_view word) const;
    void read_libraries(std::string_view rest);
    void read_library(const fs::path& relative);
    void use_material(std::string_view name);
    void check_indices() const;
    void triangulate();
    void build(Model& model);

    fs::path path_;
    std::string_view text_;
    LineReader lines_;
    std::vector<Vec3> positions_;
    std::vector<Vec4> colors_;  ///< as long as positions_ once a vertex has one
    std::vector<Vec2> uvs_;
    std::vector<Vec3> normals_;
    std::vector<Corner> corners_;
    std::vector<Face> faces_;
    std::vector<std::string> material_names_;
    std::map<std::string, int> material_indices_;
    int material_ = -1;
    std::map<std::string, MtlMaterial> library_;
    bool warned_of_short_face_ = false;
    /// By material: three corners a triangle.
    std::vector<std::vector<Corner>> triangles_;
};

// Words up to a comment.
std::string_view without_comment(std::string_view text) {
    return text.substr(0, text.find('#'));
}

float color_channel(double value) {
    return srgb_to_linear(std::clamp(static_cast<float>(value), 0.0f, 1.0f));
}

void ObjReader::read_vertex(std::string_view rest) {
    std::array<double, 7> values{};
    std::size_t count = 0;
    for (std::string_view word = take_word(rest); !word.empty() && count < 7;
         word = take_word(rest)) {
        const auto value = parse_number(word);
        if (!value) {
            fail(lines_.line_number(),
                 "a number was expected, found '" + to_utf8(word.substr(0, 40)) + "'");
        }
        values[count++] = *value;
    }
    if (count < 3) fail(lines_.line_number(), "a vertex needs three coordinates");
    const Vec3 position(static_cast<float>(values[0]), static_cast<float>(values[1]),
                        static_cast<float>(values[2]));
    for (int c = 0; c < 3; ++c) {
        if (!std::isfinite(position[c])) {
            fail(lines_.line_number(), "a vertex has a coordinate that is not a finite number",
                 "export the mesh again");
        }
    }
    positions_.push_back(position);
    // x y z w has a weight, which is for curves; x y z r g b (a) has a colour.
    if (count >= 6) {
        colors_.resize(positions_.size() - 1, Vec4(1.0f));
        colors_.emplace_back(color_channel(values[3]), color_channel(values[4]),
                             color_channel(values[5]), 1.0f);
    } else if (!colors_.empty()) {
        colors_.emplace_back(1.0f);
    }
}

std::int32_t ObjReader::read_index(std::string_view text, std::size_t count) const {
    const auto value = parse_number(text);
    const double limit = std::numeric_limits<std::int32_t>::max();
    if (!value || *value != std::floor(*value) || std::abs(*value) > limit || *value == 0.0) {
        fail(lines_.line_number(), "an index was expected (from 1, or negative), found '" +
                                       to_utf8(text.substr(0, 40)) + "'");
    }
    const auto index = static_cast<std::int64_t>(*value);
    const std::int64_t from_zero = index > 0 ? index - 1 : static_cast<std::int64_t>(count) + index;
    if (from_zero < 0) {
        fail(lines_.line_number(),
             fmt::format("index {} points before the first of {}", index, count));
    }
    return static_cast<std::int32_t>(from_zero);
}

Corner ObjReader::read_corner(std::string_view word) const {
    Corner corner;
    const std::size_t first = word.find('/');
    corner.position = read_index(word.substr(0, first), positions_.size());
    if (first == std::string_view::npos) return corner;
    const std::string_view rest = word.substr(first + 1);
    const std::size_t second = rest.find('/');
    const std::string_view uv = rest.substr(0, second);
    if (!uv.empty()) corner.uv = read_index(uv, uvs_.size());
    if (second != std::string_view::npos && second + 1 < rest.size()) {
        corner.normal = read_index(rest.substr(second + 1), normals_.size());
    }
    return corner;
}

void ObjReader::read_face(std::string_view rest) {
    const std::size_t first = corners_.size();
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
        corners_.push_back(read_corner(word));
    }
    const std::size_t count = corners_.size() - first;
    if (count < 3) {
        corners_.resize(first);
        if (!std::exchange(warned_of_short_face_, true)) {
            warn(fmt::format("{}:{}: a face of {} corners is left out", path_.string(),
                             lines_.line_number(), count));
        }
        return;
    }
    if (material_ < 0) use_material("");
    faces_.push_back({first, static_cast<std::uint32_t>(count), material_, lines_.line_number()});
}

void ObjReader::use_material(std::string_view name) {
    const auto [entry, is_new] =
        material_indices_.try_emplace(std::string(name), static_cast<int>(material_names_.size()));
    material_ = entry->second;
    if (is_new) material_names_.emplace_back(name);
}

void ObjReader::read_library(const fs::path& relative) {
    const fs::path file = resolve_in_folder(path_.parent_path(), relative, path_.string());
    for (auto& [name, material] : read_mtl(file))
        library_.insert_or_assign(name, std::move(material));
}

// One name with blanks, or several names.
void ObjReader::read_libraries(std::string_view rest) {
    std::string all(trim(rest));
    std::replace(all.begin(), all.end(), '\\', '/');
    std::error_code code;
    std::vector<std::string> names{all};
    if (!fs::exists(path_.parent_path() / all, code)) {
        names.clear();
        std::string_view words = all;
        for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
            names.emplace_back(word);
        }
    }
    for (const std::string& name : names) {
        try {
            read_library(name);
        } catch (const InputError& error) {
            warn(std::string(error.what()) + "; default materials are used");
        }
    }
}

void ObjReader::check_indices() const {
    for (const Face& face : faces_) {
        for (std::uint32_t i = 0; i < face.corner_count; ++i) {
            const Corner& corner = corners_[face.first_corner + i];
            const auto check = [&](std::int32_t index, std::size_t count, const char* what) {
                if (index >= 0 && static_cast<std::size_t>(index) >= count) {
                    fail(face.line, fmt::format("a face uses {} {} of {}", what, index + 1, count),
                         "the file is damaged or cut short");
                }
            };
            check(corner.position, positions_.size(), "vertex");
            check(corner.uv, uvs_.size(), "texture coordinate");
            check(corner.normal, normals_.size(), "normal");
        }
    }
}

void ObjReader::triangulate() {
    triangles_.resize(material_names_.size());
    std::vector<Vec3> outline;
    for (const Face& face : faces_) {
        outline.clear();
        for (std::uint32_t i = 0; i < face.corner_count; ++i) {
            outline.push_back(positions_[corners_[face.first_corner + i].position]);
        }
        for (const std::uint32_t i : triangulate_polygon(outline)) {
            triangles_[face.material].push_back(corners_[face.first_corner + i]);
        }
    }
}

void ObjReader::build(Model& model) {
    // Normals of corners that have none, over the whole file so that materials do not part them.
    std::vector<Vec3> smooth;
    bool any_without_normal = false;
    std::vector<std::uint32_t> all;
    for (const auto& triangles : triangles_) {
        for (const Corner& corner : triangles) {
            all.push_back(static_cast<std::uint32_t>(corner.position));
            any_without_normal =
                any_without_normal || corner.normal < 0 || normals_[corner.normal] == Vec3(0.0f);
        }
    }
    if (any_without_normal) smooth = smooth_normals(positions_, all);

    ObjMaterials materials(model, path_.parent_path(), path_.string());
    for (std::size_t m = 0; m < material_names_.size(); ++m) {
        if (triangles_[m].empty()) continue;
        const auto found = library_.find(material_names_[m]);
        MtlMaterial source = found != library_.end() ? found->second : MtlMaterial{};
        if (found == library_.end()) source.name = material_names_[m];
        Primitive primitive;
        primitive.material = materials.add(source);
        primitive.name =
            model.materials.back().name.empty() ? model.name : model.materials.back().name;
        const MtlMap placing = source.diffuse_map.value_or(MtlMap{});

        bool any_uv = false;
        for (const Corner& corner : triangles_[m])
            any_uv = any_uv || corner.uv >= 0;
        std::unordered_map<Corner, std::uint32_t, CornerHash> vertices;
        for (const Corner& corner : triangles_[m]) {
            const auto [entry, is_new] = vertices.try_emplace(
                corner, static_cast<std::uint32_t>(primitive.positions.size()));
            primitive.indices.push_back(entry->second);
            if (!is_new) continue;
            primitive.positions.push_back(positions_[corner.position]);
            const bool has_normal = corner.normal >= 0 && normals_[corner.normal] != Vec3(0.0f);
            primitive.normals.push_back(has_normal ? normals_[corner.normal]
                                                   : smooth[corner.position]);
            if (!colors_.empty()) primitive.colors.push_back(colors_[corner.position]);
            if (!any_uv) continue;
            const Vec2 uv =
                (corner.uv >= 0 ? uvs_[corner.uv] : Vec2(0.0f)) * placing.scale + placing.offset;
            primitive.uvs.emplace_back(uv.x, 1.0f - uv.y);
        }
        model.primitives.push_back(std::move(primitive));
    }
}

Model ObjReader::read() {
    for (std::string_view line; lines_.next(line);) {
        const std::string_view key = take_word(line);
        const std::string_view rest = without_comment(line);
        if (key == "v") {
            read_vertex(rest);
        } else if (key == "vt" || key == "vn") {
            Vec3 value(0.0f);
            std::string_view words = rest;
            for (int c = 0; c < 3; ++c) {
                const double number = parse_number(take_word(words)).value_or(0.0);
                value[c] =
                    std::isfinite(static_cast<float>(number)) ? static_cast<float>(number) : 0.0f;
            }
            if (key == "vt") {
                uvs_.emplace_back(value);
            } else {
                const double length = glm::length(glm::dvec3(value));
                normals_.push_back(length > 0.0 ? Vec3(glm::dvec3(value) / length) : Vec3(0.0f));
            }
        } else if (key == "f") {
            read_face(rest);
        } else if (key == "usemtl") {
            use_material(trim(line));
        } else if (key == "mtllib") {
            read_libraries(line);
        }
    }
    if (faces_.empty()) {
        throw InputError(
            path_.string(),
            fmt::format("a mesh with triangles was expected, found {} vertices and no faces",
                        positions_.size()),
            "export it with its faces");
    }
    check_indices();
    triangulate();
    Model model;
    model.name = to_utf8(path_.stem().string());
    build(model);
    return model;
}

}  // namespace

Model read_obj(const fs::path& path, const Bytes& bytes) {
    return ObjReader(path, bytes).read();
}

}  // namespace item3d
