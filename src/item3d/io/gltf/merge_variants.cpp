#include "item3d/io/gltf/merge_variants.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/content.h"
#include "item3d/io/gltf/import_geometry.h"
#include "item3d/io/gltf/import_material.h"
#include "item3d/io/gltf/variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

namespace item3d {
namespace {

constexpr const char* merged_extension = "KHR_materials_variants";

const Json& primitive_at(const SourceDocument& document, std::size_t mesh, std::size_t primitive) {
    return document.json.at("meshes").at(mesh).at("primitives").at(primitive);
}

std::size_t mesh_count(const SourceDocument& document, std::size_t mesh) {
    return document.json.at("meshes").at(mesh).at("primitives").size();
}

class VariantMerge {
  public:
    VariantMerge(const SourceDocument& document, const std::vector<EditedDocument>& edits,
                 const std::string& original, GltfBuilder& builder)
        : document_(document),
          edits_(edits),
          builder_(builder),
          own_(document),
          materials_(own_, builder),
          geometry_(builder) {
        for (const EditedDocument& edit : edits_) {
            contents_.push_back(std::make_unique<DocumentContent>(*edit.document));
            looks_.push_back(edit.look.empty()
                                 ? std::nullopt
                                 : std::optional(find_variant(*edit.document, edit.look)));
        }
        own_variants_ = variant_names(document).size();
        list_variants(original);
    }

    void run() {
        const Json nodes = document_.json.value("nodes", Json::array());
        for (const EditedDocument& edit : edits_)
            if (edit.document->json.value("nodes", Json::array()).size() != nodes.size())
                fail_as_other(edit);
        for (std::size_t node = 0; node < nodes.size(); ++node)
            if (nodes[node].contains("mesh"))
                merge_node(node, nodes[node]["mesh"].get<std::size_t>());
    }

  private:
    [[noreturn]] static void fail_as_other(const EditedDocument& edit) {
        throw InputError(edit.document->path.string(),
                         "is not an edited copy of the model, because its meshes differ",
                         "make the edit from the model itself");
    }

    void list_variants(const std::string& original) {
        Json& json = builder_.json();
        Json& root = json["extensions"];
        if (!root.is_object()) root = Json::object();
        const auto add = [&](const std::string& name) {
            append(root[merged_extension], "variants", Json{{"name", name}});
        };
        if (!original.empty()) {
            original_ = own_variants_;
            add(original);
        }
        first_ = own_variants_ + (original_ ? 1 : 0);
        for (const EditedDocument& edit : edits_)
            add(edit.name);
        Json& used = json["extensionsUsed"];
        if (!used.is_array()) used = Json::array();
        if (std::find(used.begin(), used.end(), merged_extension) == used.end())
            used.push_back(merged_extension);
    }

    std::size_t mesh_of(const EditedDocument& edit, std::size_t node, std::size_t mesh) const {
        const Json& other = edit.document->json.at("nodes").at(node);
        if (!other.contains("mesh")) fail_as_other(edit);
        const auto index = other["mesh"].get<std::size_t>();
        if (mesh_count(*edit.document, index) != mesh_count(document_, mesh)) fail_as_other(edit);
        return index;
    }

    void merge_node(std::size_t node, std::size_t mesh) {
        std::vector<std::size_t> meshes;  // one for each edit
        for (const EditedDocument& edit : edits_)
            meshes.push_back(mesh_of(edit, node, mesh));
        Json merged = document_.json["meshes"][mesh];
        for (std::size_t p = 0; p < merged["primitives"].size(); ++p)
            merged["primitives"][p] = merged_primitive(mesh, meshes, p);
        // Nodes that share a mesh in the source share the merged mesh too, if their merged meshes
        // are equal.
        auto& versions = versions_[mesh];
        const auto same = std::find_if(versions.begin(), versions.end(),
                                       [&](const auto& one) { return one.first == merged; });
        if (same != versions.end()) {
            builder_.json()["nodes"][node]["mesh"] = same->second;
            return;
        }
        std::size_t index = mesh;
        if (versions.empty())
            builder_.json()["meshes"][mesh] = merged;
        else
            index = append(builder_.json(), "meshes", merged);
        versions.emplace_back(std::move(merged), index);
        builder_.json()["nodes"][node]["mesh"] = index;
    }

    /// Returns the first edit that changed the primitive's vertices; no value if no edit changed
    /// them. Throws InputError if two edits changed them differently.
    std::optional<std::size_t> find_new_geometry(std::size_t mesh,
                                                 const std::vector<std::size_t>& meshes,
                                                 std::size_t primitive) {
        const std::string before = own_.geometry(mesh, primitive);
        std::optional<std::size_t> found;
        for (std::size_t e = 0; e < edits_.size(); ++e) {
            const std::string& now = contents_[e]->geometry(meshes[e], primitive);
            if (now == before) continue;
            if (!found) {
                found = e;
            } else if (now != contents_[*found]->geometry(meshes[*found], primitive)) {
                throw InputError(
                    edits_[e].document->path.string(),
                    fmt::format("has a different UV map for mesh {}, primitive {} than {}", mesh,
                                primitive, edits_[*found].document->path.string()),
                    "make the edits with the same --uv and --texture-size, or write them to "
                    "separate files");
            }
        }
        return found;
    }

    void require_colors(const Json& source, std::size_t edit, const Json& edited) const {
        if (!source.at("attributes").contains("COLOR_0") ||
            edited.at("attributes").contains("COLOR_0"))
            return;
        throw InputError(
            edits_[edit].document->path.string(),
            "has the model's vertex colours in its texture, but all variants share the vertices",
            "bake the model's vertex colours into a texture before editing");
    }

    Json merged_primitive(std::size_t mesh, const std::vector<std::size_t>& meshes, std::size_t p) {
        const Json& source = primitive_at(document_, mesh, p);
        Json primitive = source;
        const auto changed = find_new_geometry(mesh, meshes, p);
        std::size_t moved = 0;  // UV set to which the source's set 0 moved
        if (changed) {
            const SourceDocument& edited = *edits_[*changed].document;
            const Json& other = primitive_at(edited, meshes[*changed], p);
            require_colors(source, *changed, other);
            moved = moved_uv_set(document_, source, edited, other).value_or(0);
            geometry_.replace(*contents_[*changed], other, moved, primitive);
        }
        const std::string before = own_.geometry(mesh, p);
        std::map<std::size_t, std::vector<std::size_t>> mappings;  // variants by material
        const auto material = [&](const DocumentContent& content, std::optional<std::size_t> index,
                                  bool stayed, const std::string& look) {
            const std::size_t uv_set = stayed ? moved : 0;
            if (!index) return materials_.add_default();
            const std::string own_name =
                content.document().json["materials"].at(*index).value("name", std::string());
            return materials_.add(content, *index, uv_set,
                                  look.empty() ? own_name : joined_name(own_name, look));
        };
        const GltfObject source_object(document_, source, "");
        const auto own = index_of(document_, source);
        const std::size_t shown = material(own_, own, true, "");
        for (std::size_t v = 0; v < own_variants_; ++v)
            if (const auto index = material_in_variant(document_, source_object, v))
                mappings[material(own_, index, true, "")].push_back(v);
        for (std::size_t e = 0; e < edits_.size(); ++e) {
            const SourceDocument& edited = *edits_[e].document;
            const Json& other = primitive_at(edited, meshes[e], p);
            auto index = index_of(edited, other);
            if (looks_[e])
                index = material_in_variant(edited, GltfObject(edited, other, ""), *looks_[e])
                            .value_or(index.value_or(0));
            const bool stayed = contents_[e]->geometry(meshes[e], p) == before;
            const std::size_t now = material(*contents_[e], index, stayed, edits_[e].name);
            if (now != shown) mappings[now].push_back(first_ + e);
        }
        if (mappings.empty() && own) {
            primitive["material"] = shown;
            return primitive;
        }
        if (mappings.empty()) return primitive;
        primitive["material"] = shown;
        if (original_) mappings[shown].push_back(*original_);
        primitive["extensions"][merged_extension] = Json{{"mappings", Json::array()}};
        for (auto& [index, variants] : mappings)
            append(primitive["extensions"][merged_extension], "mappings",
                   Json{{"material", index}, {"variants", variants}});
        return primitive;
    }

    static std::string joined_name(const std::string& material, const std::string& look) {
        return material.empty() ? look : material + ", " + look;
    }

    static std::optional<std::size_t> index_of(const SourceDocument& document,
                                               const Json& primitive) {
        if (!primitive.contains("material")) return std::nullopt;
        const auto index = primitive["material"].get<std::size_t>();
        (void)document.json.at("materials").at(index);
        return index;
    }

    const SourceDocument& document_;
    const std::vector<EditedDocument>& edits_;
    GltfBuilder& builder_;
    DocumentContent own_;
    MaterialImport materials_;
    GeometryImport geometry_;
    std::vector<std::unique_ptr<DocumentContent>> contents_;
    std::vector<std::optional<std::size_t>> looks_;
    std::size_t own_variants_ = 0;
    std::optional<std::size_t> original_;  ///< index of the variant without edits
    std::size_t first_ = 0;                ///< index of the first edit's variant
    std::map<std::size_t, std::vector<std::pair<Json, std::size_t>>> versions_;  ///< by mesh
};

}  // namespace

void merge_variants(const SourceDocument& document, const std::vector<EditedDocument>& edits,
                    const std::string& original, GltfBuilder& builder) {
    VariantMerge(document, edits, original, builder).run();
}

}  // namespace item3d
