#include "item3d/io/obj/read.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/io/encoding.h"
#include "item3d/io/obj/libraries.h"
#include "item3d/io/obj/materials.h"
#include "item3d/io/obj/parse.h"
#include "item3d/io/obj/triangulate.h"
#include "item3d/io/text.h"
#include "item3d/scene/far_origin.h"
#include "item3d/scene/normals.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace item3d {
namespace fs = std::filesystem;
namespace {

struct CornerHash {
    std::size_t operator()(const ObjCorner& c) const {
        const auto high = static_cast<std::uint64_t>(static_cast<std::uint32_t>(c.position)) << 32;
        return mix_bits(mix_bits(high | static_cast<std::uint32_t>(c.uv)) ^
                        static_cast<std::uint32_t>(c.normal));
    }
};

/// Triangles of one material.
struct ObjTriangles {
    std::vector<ObjCorner> corners;    ///< three for each triangle
    std::vector<std::int64_t> groups;  ///< smoothing groups, one for each triangle
    std::vector<int> named_groups;     ///< Primitive::triangle_groups
};

class ObjReader {
  public:
    ObjReader(const fs::path& path, ObjFile file, const LoadOptions& options)
        : path_(path), file_(std::move(file)), libraries_(path, file_), options_(options) {}

    Model read() {
        model_.name = to_utf8(path_.stem().string());
        place();
        triangulate();
        complete_normals();
        add_materials();
        return std::move(model_);
    }

  private:
    // Sets the origin and the positions; ignores stray vertices that no face uses.
    void place() {
        glm::dvec3 low(file_.positions[file_.corners[0].position]);
        glm::dvec3 high = low;
        for (const ObjCorner& corner : file_.corners) {
            low = glm::min(low, file_.positions[corner.position]);
            high = glm::max(high, file_.positions[corner.position]);
        }
        model_.origin = far_origin(low, high);
        positions_.reserve(file_.positions.size());
        for (const glm::dvec3& position : file_.positions)
            positions_.emplace_back(position - model_.origin);
    }

    void triangulate() {
        triangles_.resize(file_.material_names.size());
        std::vector<Vec3> outline;
        for (std::size_t f = 0; f < file_.faces.size(); ++f) {
            const ObjFace& face = file_.faces[f];
            // Each flat face is its own group, with a negative number that the file cannot have.
            const std::int64_t group =
                face.smoothing == 0 ? -1 - static_cast<std::int64_t>(f) : face.smoothing;
            outline.clear();
            for (std::uint32_t i = 0; i < face.corner_count; ++i)
                outline.push_back(positions_[file_.corners[face.first_corner + i].position]);
            ObjTriangles& triangles = triangles_[face.material];
            const std::vector<std::uint32_t> chosen = triangulate_polygon(outline);
            for (const std::uint32_t i : chosen)
                triangles.corners.push_back(file_.corners[face.first_corner + i]);
            triangles.groups.insert(triangles.groups.end(), chosen.size() / 3, group);
            triangles.named_groups.insert(triangles.named_groups.end(), chosen.size() / 3,
                                          face.group);
        }
        model_.groups = file_.groups;
    }

    // Computes missing normals over the whole file, so that edges between materials stay smooth.
    void complete_normals() {
        const auto lacks_normal = [&](const ObjCorner& corner) {
            return corner.normal < 0 || file_.normals[corner.normal] == Vec3(0.0f);
        };
        std::vector<std::uint32_t> positions;
        std::vector<std::int64_t> groups;
        bool any = false;
        for (const ObjTriangles& triangles : triangles_) {
            for (const ObjCorner& corner : triangles.corners) {
                positions.push_back(static_cast<std::uint32_t>(corner.position));
                any = any || lacks_normal(corner);
            }
            groups.insert(groups.end(), triangles.groups.begin(), triangles.groups.end());
        }
        if (!any) return;
        const CornerNormals made = grouped_normals(positions_, positions, groups);
        const std::size_t first = file_.normals.size();
        file_.normals.insert(file_.normals.end(), made.normals.begin(), made.normals.end());
        std::size_t at = 0;
        for (ObjTriangles& triangles : triangles_) {
            for (ObjCorner& corner : triangles.corners) {
                const std::uint32_t normal = made.corners[at++];
                if (lacks_normal(corner)) corner.normal = static_cast<std::int32_t>(first + normal);
            }
        }
    }

    void add_materials() {
        std::vector<std::string> unknown;
        std::map<const MtlMaterial*, std::size_t> slots;
        ObjMaterials materials(model_, path_.parent_path(), path_.string(),
                               options_.texture_folders);
        // Several names can denote one material of the library. Their triangles are merged into one
        // primitive.
        std::vector<std::pair<MtlMaterial, ObjTriangles>> parts;
        for (std::size_t m = 0; m < file_.material_names.size(); ++m) {
            const std::string& name = file_.material_names[m];
            if (triangles_[m].corners.empty()) continue;
            const MtlMaterial* found = libraries_.find(name);
            if (!found && !name.empty()) unknown.push_back(name);
            const auto [slot, is_new] = slots.try_emplace(found, parts.size());
            if (found && !is_new) {
                ObjTriangles& part = parts[slot->second].second;
                const ObjTriangles& more = triangles_[m];
                part.corners.insert(part.corners.end(), more.corners.begin(), more.corners.end());
                part.named_groups.insert(part.named_groups.end(), more.named_groups.begin(),
                                         more.named_groups.end());
                continue;
            }
            parts.emplace_back(found ? *found : MtlMaterial{}, std::move(triangles_[m]));
            if (!found) parts.back().first.name = name;
        }
        for (auto& [source, triangles] : parts)
            add_primitive(materials.add(source), source, std::move(triangles));
        materials.make_visible();
        if (unknown.empty()) return;
        const std::size_t shown = std::min<std::size_t>(unknown.size(), 3);
        for (std::string& name : unknown)
            name = "'" + to_utf8(name) + "'";
        warn(fmt::format("{}: no material library defines {}{}; rendered in grey", path_.string(),
                         fmt::join(unknown.begin(), unknown.begin() + shown, ", "),
                         unknown.size() > shown
                             ? fmt::format(" and {} more", unknown.size() - shown)
                             : std::string()));
    }

    void add_primitive(int material, const MtlMaterial& source, ObjTriangles triangles) {
        const std::vector<ObjCorner>& corners = triangles.corners;
        Primitive primitive;
        if (!file_.groups.empty()) primitive.triangle_groups = std::move(triangles.named_groups);
        primitive.material = material;
        primitive.name =
            model_.materials.back().name.empty() ? model_.name : model_.materials.back().name;
        const MtlMap placing = source.diffuse_map.value_or(source.opacity_map.value_or(MtlMap{}));
        const bool any_uv = std::any_of(corners.begin(), corners.end(),
                                        [](const ObjCorner& corner) { return corner.uv >= 0; });
        std::unordered_map<ObjCorner, std::uint32_t, CornerHash> vertices;
        for (const ObjCorner& corner : corners) {
            const auto [entry, is_new] = vertices.try_emplace(
                corner, static_cast<std::uint32_t>(primitive.positions.size()));
            primitive.indices.push_back(entry->second);
            if (!is_new) continue;
            primitive.positions.push_back(positions_[corner.position]);
            primitive.normals.push_back(file_.normals[corner.normal]);
            if (!file_.colors.empty()) primitive.colors.push_back(file_.colors[corner.position]);
            if (!any_uv) continue;
            const Vec2 uv = (corner.uv >= 0 ? file_.uvs[corner.uv] : Vec2(0.0f)) * placing.scale +
                            placing.offset;
            primitive.uvs.emplace_back(uv.x, 1.0f - uv.y);
        }
        model_.primitives.push_back(std::move(primitive));
    }

    fs::path path_;
    ObjFile file_;
    ObjLibraries libraries_;
    LoadOptions options_;
    std::vector<Vec3> positions_;          ///< with the origin subtracted
    std::vector<ObjTriangles> triangles_;  ///< by name of the material
    Model model_;
};

}  // namespace

Model read_obj(const fs::path& path, const Bytes& bytes, const LoadOptions& options) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::string decoded;
    const bool is_plain = is_utf8(text) && text.find('\0') == std::string_view::npos;
    if (!is_plain) decoded = decode_text(text, names_below(path.parent_path()), path.string());
    ObjFile file = parse_obj(is_plain ? text : decoded, path.string());
    if (file.faces.empty()) {
        throw InputError(
            path.string(),
            fmt::format("expected a mesh with triangles, found {} vertices and no faces",
                        file.positions.size()),
            "export it with its faces");
    }
    return ObjReader(path, std::move(file), options).read();
}

}  // namespace item3d
