#include "item3d/io/gltf/patch.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/gltf/draco.h"
#include "item3d/io/gltf/patch_material.h"
#include "item3d/io/gltf/uv_layouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>

namespace item3d {
namespace {

std::string uv_name(std::size_t set) {
    return fmt::format("TEXCOORD_{}", set);
}

/// Changes of one primitive of one mesh.
struct PrimitiveChange {
    int primitive;
    int material;                               ///< index into GltfPatch::plans_ and edits
    std::shared_ptr<const PrimitiveEdit> edit;  ///< null if the vertices stay unchanged
    const std::vector<Vec2>* uvs;               ///< texture coordinates of the original primitive
    std::size_t vertex_count;

    bool operator==(const PrimitiveChange& other) const {
        const bool same_edit =
            edit == other.edit || (edit && other.edit && edit->uvs == other.edit->uvs &&
                                   edit->indices == other.edit->indices &&
                                   edit->source_vertices == other.edit->source_vertices);
        return primitive == other.primitive && material == other.material && same_edit &&
               *uvs == *other.uvs;
    }
};

class GltfPatch {
  public:
    GltfPatch(const SourceDocument& document, std::span<const PrimitiveUse> uses,
              const ModelEdit& edit, GltfBuilder& builder)
        : document_(document),
          edit_(edit),
          builder_(builder),
          default_material_(static_cast<int>(
              document.json.contains("materials") ? document.json["materials"].size() : 0)) {
        // All instances of a node (EXT_mesh_gpu_instancing) are one primitive of the document.
        std::set<std::array<int, 3>> seen;
        for (const PrimitiveUse& use : uses) {
            if (seen.insert({use.mesh, use.primitive, use.node}).second) uses_.push_back(use);
        }
    }

    void run() {
        for (const PrimitiveUse& use : uses_)
            make_plan(use);
        for (const auto& [material, edit] : edit_.materials)
            change_material(material);
        for (const auto& [material, plan] : plans_) {
            if (!edit_.materials.contains(material)) change_material(material);
        }
        change_meshes();
        std::set<std::pair<int, int>> shown;
        for (const PrimitiveUse& use : uses_)
            shown.insert({use.mesh, use.primitive});
        std::set<int> changed = moved_lods_;
        for (const auto& [material, plan] : plans_)
            changed.insert(material);
        keep_unseen_meshes(document_, shown, changed, builder_.json());
    }

  private:
    int material_of(const PrimitiveUse& use) const {
        return use.material < 0 ? default_material_ : use.material;
    }

    const Json& source_primitive(int mesh, int primitive) const {
        return document_.json["meshes"][static_cast<std::size_t>(mesh)]["primitives"]
                             [static_cast<std::size_t>(primitive)];
    }

    // New texture coordinates of one primitive affect its material, and so all primitives that
    // share it.
    void make_plan(const PrimitiveUse& use) {
        if (!edit_.primitives.contains(use.index)) return;
        const int material = material_of(use);
        UvPlan& plan = plans_[material];
        plan.has_new_uvs = true;
        std::size_t sets = 0;
        bool stays = false;
        for (const PrimitiveUse& other : uses_) {
            if (material_of(other) != material) continue;
            const Json& primitive = source_primitive(other.mesh, other.primitive);
            while (primitive["attributes"].contains(uv_name(sets)))
                ++sets;
            stays = stays || has_extension(primitive, "KHR_materials_variants") ||
                    has_extension(primitive, "EXT_structural_metadata");
        }
        for (const std::size_t lod : own_lod_materials(material))
            stays = stays || is_shown_elsewhere(static_cast<int>(lod), material);
        // Edited textures use set 0, which viewers support best, unless other materials may use the
        // old set 0.
        plan.new_set = stays ? sets : 0;
        plan.moved_set.reset();
        if (!stays && sets > 0) plan.moved_set = sets;
    }

    static bool has_extension(const Json& object, const char* name) {
        return object.contains("extensions") && object["extensions"].contains(name);
    }

    std::vector<std::size_t> own_lod_materials(int material) const {
        if (material == default_material_) return {};
        return lod_materials(document_, static_cast<std::size_t>(material));
    }

    /// True if a primitive uses `material`, or if `material` replaces a material other than `owner`
    /// at a distance (MSFT_lod).
    bool is_shown_elsewhere(int material, int owner) const {
        if (std::any_of(uses_.begin(), uses_.end(),
                        [&](const PrimitiveUse& use) { return material_of(use) == material; }))
            return true;
        for (int other = 0; other < default_material_; ++other) {
            const auto lods = own_lod_materials(other);
            if (other != owner && std::find(lods.begin(), lods.end(), material) != lods.end())
                return true;
        }
        return edit_.materials.contains(material);
    }

    UvPlan plan_of(int material) const {
        const auto found = plans_.find(material);
        return found == plans_.end() ? UvPlan{} : found->second;
    }

    void change_material(int index) {
        const bool is_default = index == default_material_;
        ITEM3D_CHECK(index >= 0 && index <= default_material_,
                     fmt::format("an edit refers to material {} of {}", index, default_material_));
        if (is_default && !edit_.materials.contains(index)) return;
        if (is_default) append(builder_.json(), "materials", Json::object());
        Json& material = builder_.json()["materials"][static_cast<std::size_t>(index)];
        const UvPlan plan = plan_of(index);
        const auto edit = edit_.materials.find(index);
        if (plan.moved_set) {
            move_texture_coordinates(material, *plan.moved_set);
            for (const std::size_t lod : own_lod_materials(index)) {
                if (moved_lods_.insert(static_cast<int>(lod)).second)
                    move_texture_coordinates(builder_.json()["materials"][lod], *plan.moved_set);
            }
        }
        if (edit == edit_.materials.end()) return;
        std::string name = material.value("name", std::string());
        if (name.empty()) name = fmt::format("material_{}", index);
        // A copy stays valid whatever patch_material() adds to the document.
        Json copy = material;
        const Json original = is_default
                                  ? Json::object()
                                  : document_.json["materials"][static_cast<std::size_t>(index)];
        const std::vector<ReplacedTexture> replaced =
            patch_material(document_, original, edit->second, plan, name, copy, builder_);
        builder_.json()["materials"][static_cast<std::size_t>(index)] = std::move(copy);
        if (is_default) return;
        const auto number = static_cast<std::size_t>(index);
        follow_vrm(document_, number, replaced, plan.has_new_uvs, builder_.json());
        warn_of_animations(document_, number);
    }

    bool drops_colors(int material) const {
        const auto edit = edit_.materials.find(material);
        return edit != edit_.materials.end() && edit->second.base_color &&
               edit->second.includes_vertex_colors;
    }

    std::size_t uv_set_of(int material) const {
        if (material == default_material_) return 0;
        return material_uv_layout(
                   root_of(document_).item("materials", static_cast<std::size_t>(material)))
            .tex_coord;
    }

    /// True if a new normal texture uses other coordinates than the old one did.
    bool moves_normal(int material) const {
        const auto edit = edit_.materials.find(material);
        if (edit == edit_.materials.end() || !edit->second.normal || material == default_material_)
            return false;
        const GltfObject source =
            root_of(document_).item("materials", static_cast<std::size_t>(material));
        const auto normal = source.object("normalTexture");
        return plan_of(material).has_new_uvs ||
               (normal && read_uv_layout(*normal) != material_uv_layout(source));
    }

    // True if a primitive has edited textures but no UVs, and needs dummy UVs.
    bool lacks_uvs(const PrimitiveUse& use) const {
        const int material = material_of(use);
        const auto edit = edit_.materials.find(material);
        const bool has_images =
            edit != edit_.materials.end() &&
            (edit->second.base_color || edit->second.metallic_roughness || edit->second.normal);
        return has_images && !source_primitive(use.mesh, use.primitive)["attributes"].contains(
                                 uv_name(uv_set_of(material)));
    }

    std::optional<PrimitiveChange> change_of(const PrimitiveUse& use) const {
        const int material = material_of(use);
        const bool is_new_default = use.material < 0 && edit_.materials.contains(material);
        const bool has_colors =
            source_primitive(use.mesh, use.primitive)["attributes"].contains("COLOR_0");
        if (!plan_of(material).has_new_uvs && !is_new_default && !lacks_uvs(use) &&
            !(drops_colors(material) && has_colors) && !moves_normal(material)) {
            return std::nullopt;
        }
        PrimitiveChange change{use.primitive, material, nullptr, use.uvs, use.vertex_count};
        const auto found = edit_.primitives.find(use.index);
        if (found != edit_.primitives.end()) {
            PrimitiveEdit edit = found->second;
            ITEM3D_CHECK(edit.uvs.size() == edit.source_vertices.size(),
                         "a PrimitiveEdit needs one uv for each vertex");
            if (const auto* split = split_vertices(use.mesh, use.primitive)) {
                for (std::uint32_t& vertex : edit.source_vertices)
                    vertex = split->at(vertex);
            }
            // The file's triangles have the mesh's winding, not that of the mirrored node.
            for (std::size_t t = 0; use.is_mirrored && t + 2 < edit.indices.size(); t += 3) {
                std::swap(edit.indices[t + 1], edit.indices[t + 2]);
            }
            change.edit = std::make_shared<const PrimitiveEdit>(std::move(edit));
        }
        return change;
    }

    // Applies changes to meshes. Nodes that share a mesh continue to share it if their changes are
    // equal; each different change gets a copy of the mesh.
    void change_meshes() {
        std::map<std::pair<int, int>, std::vector<PrimitiveChange>> by_node;  // by (mesh, node)
        std::vector<std::pair<int, int>> order;
        for (const PrimitiveUse& use : uses_) {
            const std::pair key(use.mesh, use.node);
            if (!by_node.contains(key)) order.push_back(key);
            std::vector<PrimitiveChange>& changes = by_node[key];
            if (auto change = change_of(use)) changes.push_back(std::move(*change));
        }
        struct Version {
            const std::vector<PrimitiveChange>* changes;
            std::size_t mesh;
        };
        std::map<int, std::vector<Version>> versions;
        for (const auto& key : order) {
            const auto& changes = by_node[key];
            std::vector<Version>& made = versions[key.first];
            const auto same = std::find_if(made.begin(), made.end(),
                                           [&](const Version& v) { return *v.changes == changes; });
            if (same != made.end()) {
                use_mesh(key.second, key.first, same->mesh);
                continue;
            }
            Json mesh = document_.json["meshes"][static_cast<std::size_t>(key.first)];
            for (const PrimitiveChange& change : changes)
                apply(change, key.first, mesh);
            auto index = static_cast<std::size_t>(key.first);
            if (made.empty()) {
                builder_.json()["meshes"][index] = std::move(mesh);
            } else {
                index = append(builder_.json(), "meshes", std::move(mesh));
            }
            made.push_back({&changes, index});
            use_mesh(key.second, key.first, index);
        }
    }

    void use_mesh(int node, int old_mesh, std::size_t mesh) {
        if (node < 0 || mesh == static_cast<std::size_t>(old_mesh)) return;
        builder_.json()["nodes"][static_cast<std::size_t>(node)]["mesh"] = mesh;
    }

    const std::vector<std::uint32_t>* split_vertices(int mesh, int primitive) const {
        const auto found = document_.split_vertices.find({mesh, primitive});
        return found == document_.split_vertices.end() ? nullptr : &found->second;
    }

    // Returns the coordinates in the document's order of vertices.
    std::vector<Vec2> document_uvs(const PrimitiveChange& change, int mesh) const {
        std::vector<Vec2> uvs = *change.uvs;
        uvs.resize(change.vertex_count, Vec2(0.0f));
        const std::vector<std::uint32_t>* split = split_vertices(mesh, change.primitive);
        if (!split) return uvs;
        const Json& attributes = source_primitive(mesh, change.primitive)["attributes"];
        std::vector<Vec2> result(
            accessor_shape(document_, attributes["POSITION"].get<std::size_t>()).count, Vec2(0.0f));
        for (std::size_t i = 0; i < split->size(); ++i)
            result[(*split)[i]] = uvs[i];
        return result;
    }

    void apply(const PrimitiveChange& change, int mesh_index, Json& mesh) {
        Json& primitive = mesh["primitives"][static_cast<std::size_t>(change.primitive)];
        const auto edit = edit_.materials.find(change.material);
        if (!primitive.contains("material") && edit != edit_.materials.end()) {
            primitive["material"] = change.material;
        }
        UvPlan plan = plan_of(change.material);
        if (change.edit) gather(*change.edit, primitive);
        if (!plan.has_new_uvs && edit != edit_.materials.end()) {
            plan.new_set = uv_set_of(change.material);
            if (!primitive["attributes"].contains(uv_name(plan.new_set))) {
                set_uvs(change, mesh_index, plan, primitive["attributes"]);
            }
        }
        if (plan.has_new_uvs) {
            set_uvs(change, mesh_index, plan, primitive["attributes"]);
            if (plan.moved_set && primitive.contains("extensions"))
                move_texture_coordinates(primitive["extensions"], *plan.moved_set);
        }
        // The tangent frame depends on the coordinates of the normal map.
        if (moves_normal(change.material)) drop_attribute("TANGENT", primitive);
        if (drops_colors(change.material)) drop_colors(primitive);
        match_draco(source_primitive(mesh_index, change.primitive), primitive);
    }

    static void drop_attribute(const char* name, Json& primitive) {
        primitive["attributes"].erase(name);
        if (!primitive.contains("targets")) return;
        for (Json& target : primitive["targets"])
            target.erase(name);
    }

    void drop_colors(Json& primitive) {
        Json& attributes = primitive["attributes"];
        if (!attributes.contains("COLOR_0")) return;
        if (!attributes.contains("COLOR_1")) {
            drop_attribute("COLOR_0", primitive);
            return;
        }
        // Numbers of colour sets must start at 0: white replaces the dropped set.
        Accessor white;
        white.component_type = ComponentType::u8;
        white.type = "VEC4";
        white.components = 4;
        white.normalized = true;
        const std::size_t position = attributes["POSITION"].get<std::size_t>();
        const auto count = builder_.json()["accessors"][position]["count"].get<std::size_t>();
        attributes["COLOR_0"] = builder_.add_vertices(white, Bytes(4 * count, 255), false);
    }

    void set_uvs(const PrimitiveChange& change, int mesh_index, const UvPlan& plan,
                 Json& attributes) {
        const std::vector<Vec2> uvs =
            change.edit ? change.edit->uvs : document_uvs(change, mesh_index);
        const std::span<const float> values(reinterpret_cast<const float*>(uvs.data()),
                                            2 * uvs.size());
        const std::size_t accessor = builder_.add_floats(values, 2);
        const std::string name = uv_name(plan.new_set);
        if (plan.moved_set && attributes.contains(name)) {
            attributes[uv_name(*plan.moved_set)] = attributes[name];
        }
        attributes[name] = accessor;
        const std::size_t last = plan.moved_set ? *plan.moved_set : plan.new_set;
        for (std::size_t set = 0; set < last; ++set) {
            if (!attributes.contains(uv_name(set))) attributes[uv_name(set)] = accessor;
        }
        if (!attributes.contains(uv_name(last))) attributes[uv_name(last)] = accessor;
    }

    std::size_t gather_accessor(std::size_t index, const PrimitiveEdit& edit) {
        const Accessor source = read_accessor(document_, index);
        Bytes bytes(edit.source_vertices.size() * source.element_size);
        for (std::size_t i = 0; i < edit.source_vertices.size(); ++i) {
            if (edit.source_vertices[i] >= source.count) {
                root_of(document_)
                    .item("accessors", index)
                    .fail(fmt::format("has {} elements, fewer than its primitive's vertices",
                                      source.count));
            }
            std::memcpy(bytes.data() + i * source.element_size,
                        source.bytes.data() + edit.source_vertices[i] * source.element_size,
                        source.element_size);
        }
        const Json& old = document_.json["accessors"][index];
        const std::size_t result = builder_.add_vertices(source, bytes, old.contains("min"));
        for (const char* key : {"name", "extras"}) {
            if (old.contains(key)) builder_.json()["accessors"][result][key] = old[key];
        }
        return result;
    }

    void gather(const PrimitiveEdit& edit, Json& primitive) {
        for (auto& [name, accessor] : primitive["attributes"].items()) {
            accessor = gather_accessor(accessor.get<std::size_t>(), edit);
        }
        if (primitive.contains("targets")) {
            for (Json& target : primitive["targets"]) {
                for (auto& [name, accessor] : target.items()) {
                    accessor = gather_accessor(accessor.get<std::size_t>(), edit);
                }
            }
        }
        primitive["indices"] = builder_.add_indices(edit.indices, edit.source_vertices.size());
        primitive.erase("mode");
        // The new vertices are uncompressed, so the compressed copy of the old vertices is dropped.
        const std::string draco = draco_extension;
        if (!primitive.contains("extensions") || !primitive["extensions"].contains(draco)) return;
        primitive["extensions"].erase(draco);
        if (primitive["extensions"].empty()) primitive.erase("extensions");
    }

    const SourceDocument& document_;
    std::vector<PrimitiveUse> uses_;
    const ModelEdit& edit_;
    GltfBuilder& builder_;
    int default_material_;
    std::map<int, UvPlan> plans_;
    std::set<int> moved_lods_;
};

}  // namespace

void patch_gltf(const SourceDocument& document, std::span<const PrimitiveUse> uses,
                const ModelEdit& edit, GltfBuilder& builder) {
    GltfPatch(document, uses, edit, builder).run();
}

}  // namespace item3d
