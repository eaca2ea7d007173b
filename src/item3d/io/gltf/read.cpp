// Conversion of glTF 2.0 (Khronos, ISO/IEC 12113:2022) to a Model. The model has one primitive for
// each triangle primitive of each node of the default scene, in world space. Animations are not
// applied: morph weights and node transforms have their default values.
#include "item3d/io/gltf/read.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/gltf/accessors.h"
#include "item3d/io/gltf/draco.h"
#include "item3d/io/gltf/finite_attributes.h"
#include "item3d/io/gltf/instances.h"
#include "item3d/io/gltf/materials.h"
#include "item3d/io/gltf/nodes.h"
#include "item3d/io/gltf/skin.h"
#include "item3d/io/gltf/uv_layouts.h"
#include "item3d/io/gltf/variants.h"
#include "item3d/io/gltf/vertices.h"
#include "item3d/scene/far_origin.h"
#include "item3d/scene/normals.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>

namespace item3d {
namespace {

// Supported extensions that a file may require, including those without effect on the data that is
// read.
constexpr std::string_view known_extensions[] = {
    "KHR_mesh_quantization",      "KHR_texture_transform", "KHR_lights_punctual",
    "KHR_animation_pointer",      "KHR_xmp_json_ld",       "EXT_meshopt_compression",
    "KHR_draco_mesh_compression", "KHR_texture_basisu",    "EXT_texture_webp",
    "EXT_mesh_gpu_instancing",    "KHR_node_visibility",
};

void check_required_extensions(const SourceDocument& document) {
    const GltfObject root = root_of(document);
    const std::size_t count = root.list_size("extensionsRequired");
    for (std::size_t i = 0; i < count; ++i) {
        const Json& item = document.json["extensionsRequired"][i];
        const std::string name = item.is_string() ? item.get<std::string>() : "?";
        if (name.starts_with("KHR_materials_") ||
            std::find(std::begin(known_extensions), std::end(known_extensions), name) !=
                std::end(known_extensions)) {
            continue;
        }
        std::string hint = "export it without that extension";
        if (name == "EXT_texture_avif" || name == "MSFT_texture_dds") {
            hint = "convert its textures to PNG, JPEG, WebP or KTX2 first";
        }
        root.fail("requires the glTF extension " + name + ", which is not supported", hint);
    }
}

class GltfReader {
  public:
    GltfReader(std::shared_ptr<SourceDocument> document, const std::string& variant)
        : document_(std::move(document)), root_(root_of(*document_)) {
        if (!variant.empty()) variant_ = find_variant(*document_, variant);
    }

    Model read();

  private:
    void add_meshes();
    /// world: matrix of the mesh, if it has no skin.
    void add_mesh(std::size_t mesh, std::optional<std::size_t> node, const glm::dmat4& world);
    void add_node(std::size_t node);
    void add_primitive(const GltfObject& mesh, const GltfObject& source, Primitive primitive,
                       std::optional<std::size_t> node, const glm::dmat4& world);
    void choose_material(const GltfObject& source, Primitive& primitive);
    std::vector<double> morph_weights(const GltfObject& mesh, const GltfObject& source,
                                      std::optional<std::size_t> node) const;
    void place(const Vertices& vertices, const std::vector<glm::dmat4>& matrices,
               Primitive& primitive);
    std::vector<Vec2> read_uv_map(const GltfObject& attributes, const UvLayout& layout,
                                  const Primitive& primitive);
    void read_uvs(const GltfObject& attributes, Primitive& primitive);
    void read_colors(const GltfObject& attributes, Primitive& primitive) const;
    void read_triangles(const GltfObject& source, std::size_t mode, Primitive& primitive) const;
    std::size_t max_vertices() const;
    void count_vertices(const GltfObject& source, std::size_t count);

    std::optional<std::size_t> accessor_of(const GltfObject& object, const char* key) const {
        return object.index(key, root_.list_size("accessors"));
    }

    std::shared_ptr<SourceDocument> document_;
    GltfObject root_;
    NodeTree nodes_;
    Model model_;
    /// Corners of the box of all positions, in world space.
    glm::dvec3 low_{std::numeric_limits<double>::max()};
    glm::dvec3 high_{std::numeric_limits<double>::lowest()};
    std::set<std::string> warnings_;
    std::optional<std::size_t> variant_;
    std::vector<std::set<int>> variant_materials_;
    std::size_t vertex_count_ = 0;
    std::vector<MaterialUse> uses_;  ///< by material, the default one last
};

// Returns the limit of vertices. The limit follows from the file's size, because a few nodes could
// repeat a mesh many times.
std::size_t GltfReader::max_vertices() const {
    std::size_t size_of_file = 0;
    for (const Bytes& buffer : document_->buffers)
        size_of_file += buffer.size();
    return std::min<std::size_t>(1 << 26, std::max<std::size_t>(1 << 20, 64 * size_of_file));
}

void GltfReader::count_vertices(const GltfObject& source, std::size_t count) {
    const std::size_t limit = max_vertices();
    vertex_count_ += count;
    if (count > limit || vertex_count_ > limit) {
        source.fail(fmt::format("more than {} vertices in total", limit), "split the model");
    }
}

std::vector<double> GltfReader::morph_weights(const GltfObject& mesh, const GltfObject& source,
                                              std::optional<std::size_t> node) const {
    const std::size_t count = source.list_size("targets");
    if (count == 0) return {};
    std::vector<double> weights;
    if (node) weights = root_.item("nodes", *node).numbers("weights", count);
    if (weights.empty()) weights = mesh.numbers("weights", count);
    return weights;
}

// matrices: one for all vertices, or one for each.
void GltfReader::place(const Vertices& vertices, const std::vector<glm::dmat4>& matrices,
                       Primitive& primitive) {
    const std::size_t count = vertices.positions.size();
    primitive.is_mirrored = count > 0 && glm::determinant(glm::dmat3(matrices[0])) < 0.0;
    bool all_normals = !vertices.normals.empty();
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dmat4& matrix = matrices[matrices.size() == 1 ? 0 : i];
        const glm::dvec3 x(matrix[0]), y(matrix[1]), z(matrix[2]);
        const glm::dvec3 position(matrix * glm::dvec4(vertices.positions[i], 1.0));
        low_ = glm::min(low_, position);
        high_ = glm::max(high_, position);
        primitive.positions.emplace_back(position - model_.origin);
        if (all_normals) {
            // Cofactors are the inverse transpose times the determinant and exist for any matrix.
            const glm::dvec3& n = vertices.normals[i];
            glm::dvec3 normal =
                glm::cross(y, z) * n.x + glm::cross(z, x) * n.y + glm::cross(x, y) * n.z;
            if (primitive.is_mirrored) normal = -normal;
            const double length = glm::length(normal);
            all_normals = std::isfinite(length) && length > 0.0;
            if (all_normals) primitive.normals.emplace_back(normal / length);
        }
        if (!vertices.tangents.empty()) {
            const glm::dvec4& t = vertices.tangents[i];
            const glm::dvec3 tangent = x * t.x + y * t.y + z * t.z;
            const double length = glm::length(tangent);
            const glm::dvec3 direction = std::isfinite(length) && length > 0.0
                                             ? tangent / length
                                             : glm::dvec3(1.0, 0.0, 0.0);
            primitive.tangents.emplace_back(Vec3(direction),
                                            (t.w < 0.0) != primitive.is_mirrored ? -1.0f : 1.0f);
        }
    }
    if (!all_normals) primitive.normals.clear();
}

std::vector<Vec2> GltfReader::read_uv_map(const GltfObject& attributes, const UvLayout& layout,
                                          const Primitive& primitive) {
    std::vector<Vec2> map;
    const std::string name = fmt::format("TEXCOORD_{}", layout.tex_coord);
    const auto index = accessor_of(attributes, name.c_str());
    if (!index) return map;
    const Accessor uvs = read_vectors(*document_, *index, 2, 2);
    check_count(attributes, name.c_str(), uvs.count, primitive.positions.size());
    for (std::size_t i = 0; i < uvs.count; ++i) {
        Vec2 uv(uvs.value(i, 0), uvs.value(i, 1));
        if (layout.is_transformed()) uv = layout.apply(uv);
        // Compressed data and large transforms can still contain or make such numbers.
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = Vec2(0.0f);
        map.push_back(uv);
    }
    return map;
}

void GltfReader::read_uvs(const GltfObject& attributes, Primitive& primitive) {
    const auto material = static_cast<std::size_t>(primitive.material);
    std::vector<UvLayout> layouts(1);
    if (material < root_.list_size("materials"))
        layouts = material_uv_layouts(root_.item("materials", material));
    MaterialUse& use = uses_[material];
    ++use.primitives;
    std::set<std::size_t> sets;
    for (std::size_t k = 0; k < layouts.size(); ++k) {
        std::vector<Vec2> map = read_uv_map(attributes, layouts[k], primitive);
        if (!map.empty() && sets.insert(layouts[k].tex_coord).second)
            ++use.with_uv_map[layouts[k].tex_coord];
        if (k == 0)
            primitive.uvs = std::move(map);
        else
            primitive.further_uvs.push_back(std::move(map));
    }
}

void GltfReader::read_colors(const GltfObject& attributes, Primitive& primitive) const {
    const auto index = accessor_of(attributes, "COLOR_0");
    if (!index) return;
    const Accessor colors = read_vectors(*document_, *index, 3, 4);
    check_count(attributes, "COLOR_0", colors.count, primitive.positions.size());
    for (std::size_t i = 0; i < colors.count; ++i) {
        Vec4 color(1.0f);
        for (std::size_t c = 0; c < colors.components; ++c) {
            const float value = colors.value(i, c);
            color[static_cast<int>(c)] = std::isfinite(value) ? std::max(value, 0.0f) : 1.0f;
        }
        primitive.colors.push_back(color);
    }
}

void GltfReader::read_triangles(const GltfObject& source, std::size_t mode,
                                Primitive& primitive) const {
    std::vector<std::uint32_t> corners;
    if (const auto index = accessor_of(source, "indices")) {
        corners = read_indices(*document_, *index);
    } else {
        corners.resize(primitive.positions.size());
        for (std::size_t i = 0; i < corners.size(); ++i)
            corners[i] = static_cast<std::uint32_t>(i);
    }
    for (const std::uint32_t corner : corners) {
        if (corner >= primitive.positions.size()) {
            source.fail(fmt::format("index {} of {} vertices", corner, primitive.positions.size()),
                        "the file is damaged; export it again");
        }
    }
    if (mode == 4) {
        corners.resize(corners.size() / 3 * 3);
        primitive.indices = std::move(corners);
    } else {
        for (std::size_t i = 2; i < corners.size(); ++i) {
            // Strips alternate their winding, fans share their first corner.
            const std::size_t odd = mode == 5 ? i % 2 : 0;
            const std::size_t first = mode == 5 ? i - 2 : 0;
            primitive.indices.insert(primitive.indices.end(),
                                     {corners[first], corners[i - 1 + odd], corners[i - odd]});
        }
    }
    if (!primitive.is_mirrored) return;
    for (std::size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
        std::swap(primitive.indices[t + 1], primitive.indices[t + 2]);
    }
}

void GltfReader::choose_material(const GltfObject& source, Primitive& primitive) {
    const std::size_t materials = root_.list_size("materials");
    const std::size_t own = source.index("material", materials).value_or(materials);
    std::size_t chosen = own;
    for (std::size_t v = 0; v < variant_materials_.size(); ++v) {
        const std::size_t material = material_in_variant(*document_, source, v).value_or(own);
        variant_materials_[v].insert(static_cast<int>(material));
        if (variant_ == v) chosen = material;
    }
    primitive.material = static_cast<int>(chosen);
}

void GltfReader::add_primitive(const GltfObject& mesh, const GltfObject& source,
                               Primitive primitive, std::optional<std::size_t> node,
                               const glm::dmat4& world) {
    const std::size_t mode = source.integer("mode", 4);
    if (mode > 6) source.fail(fmt::format("mode {} is unknown", mode));
    const auto attributes = source.object("attributes");
    if (mode < 4 || !attributes || !attributes->has("POSITION")) return;
    const GltfObject position = root_.item("accessors", *accessor_of(*attributes, "POSITION"));
    count_vertices(source, position.integer("count"));
    if (needs_draco(*document_, source)) decode_draco_primitive(*document_, source);
    choose_material(source, primitive);

    Vertices vertices = read_vertices(*document_, *attributes);
    if (const double part = float32_step(vertices.positions); part > 1e-4) {
        warnings_.insert(
            fmt::format("{}: mesh '{}' is so far from its origin that its 32-bit positions have "
                        "steps of {:.1g} of its size; export it closer to the origin",
                        document_->path.string(), primitive.name, part));
    }
    apply_morph_targets(*document_, source, morph_weights(mesh, source, node), vertices);
    std::vector<glm::dmat4> matrices{world};
    if (node && attributes->has("JOINTS_0")) {
        // The node's own transform does not apply to a skinned mesh.
        const auto skin = root_.item("nodes", *node).index("skin", root_.list_size("skins"));
        if (skin && !vertices.positions.empty()) {
            matrices =
                blend_joints(*document_, nodes_, *attributes, *skin, vertices.positions.size());
        }
    }
    place(vertices, matrices, primitive);
    for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
        const Vec3& p = primitive.positions[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
            source.fail(fmt::format("vertex {} has a coordinate that is not a finite number", i),
                        "export the mesh again");
        }
    }
    read_uvs(*attributes, primitive);
    read_colors(*attributes, primitive);
    read_triangles(source, mode, primitive);
    if (primitive.indices.empty()) return;
    if (!attributes->has("NORMAL")) {
        count_vertices(source, primitive.indices.size());
        document_->split_vertices[{primitive.source_mesh, primitive.source_primitive}] =
            make_flat(primitive);
    } else if (primitive.normals.empty()) {
        primitive.normals = smooth_normals(primitive.positions, primitive.indices);
    }
    model_.primitives.push_back(std::move(primitive));
}

void GltfReader::add_mesh(std::size_t index, std::optional<std::size_t> node,
                          const glm::dmat4& world) {
    const GltfObject mesh = root_.item("meshes", index);
    std::string name = mesh.text("name", "");
    if (node) name = root_.item("nodes", *node).text("name", name);
    if (name.empty()) name = fmt::format("mesh_{}", index);
    const std::size_t count = mesh.list_size("primitives");
    for (std::size_t i = 0; i < count; ++i) {
        Primitive primitive;
        primitive.name = count > 1 ? fmt::format("{}_{}", name, i) : name;
        primitive.source_mesh = static_cast<int>(index);
        primitive.source_primitive = static_cast<int>(i);
        primitive.source_node = node ? static_cast<int>(*node) : -1;
        add_primitive(mesh, mesh.item("primitives", i), std::move(primitive), node, world);
    }
}

void GltfReader::add_node(std::size_t node) {
    const auto mesh = root_.item("nodes", node).index("mesh", root_.list_size("meshes"));
    if (!mesh) return;
    const auto instances = read_instances(*document_, nodes_, node);
    if (!instances) return add_mesh(*mesh, node, nodes_.world[node]);
    const std::size_t before = vertex_count_;
    for (std::size_t i = 0; i < instances->size(); ++i) {
        const std::size_t of_one = i == 0 ? 0 : (vertex_count_ - before) / i;
        if (vertex_count_ + of_one > max_vertices()) {
            warn(
                fmt::format("{}: nodes[{}]: {} of its {} instances are used, because more would "
                            "exceed the limit of vertices",
                            document_->path.string(), node, i, instances->size()));
            return;
        }
        add_mesh(*mesh, node, (*instances)[i]);
    }
}

void GltfReader::add_meshes() {
    const std::size_t meshes = root_.list_size("meshes");
    model_.primitives.clear();
    vertex_count_ = 0;
    uses_.assign(root_.list_size("materials") + 1, {});
    variant_materials_.assign(variant_names(*document_).size(), {});
    for (const std::size_t node : nodes_.scene)
        add_node(node);
    if (nodes_.world.empty()) {
        // A file without nodes is a library of meshes: all meshes are shown.
        for (std::size_t mesh = 0; mesh < meshes; ++mesh)
            add_mesh(mesh, std::nullopt, glm::dmat4(1.0));
    }
}

Model GltfReader::read() {
    check_required_extensions(*document_);
    nodes_ = read_nodes(*document_);
    const std::size_t meshes = root_.list_size("meshes");
    add_meshes();
    // The few models far from the origin are read again, with the origin subtracted.
    model_.origin = far_origin(low_, high_);
    if (model_.origin != glm::dvec3(0.0)) add_meshes();
    for (const std::string& warning : warnings_)
        warn(warning);
    if (model_.primitives.empty()) {
        throw InputError(
            document_->path.string(),
            fmt::format("expected a mesh with triangles, found none in {} meshes", meshes),
            "export a model with triangles in its default scene");
    }
    read_gltf_materials(*document_, uses_, model_);
    if (uses_.back().primitives > 0) model_.materials.push_back(default_gltf_material());
    const std::vector<std::string> variants = variant_names(*document_);
    for (std::size_t v = 0; v < variants.size(); ++v) {
        const std::set<int>& materials = variant_materials_[v];
        model_.variants.push_back({variants[v],
                                   {materials.begin(), materials.lower_bound(static_cast<int>(
                                                           model_.materials.size()))}});
    }
    model_.name = document_->path.stem().string();
    model_.source = document_;
    return std::move(model_);
}

}  // namespace

Model read_gltf(const std::filesystem::path& path, const Bytes& bytes, const LoadOptions& options) {
    const auto document = parse_gltf(path, bytes);
    document->texture_folders = options.texture_folders;
    for (const std::string& warning : replace_not_finite(*document))
        warn(warning);
    return GltfReader(document, options.variant).read();
}

}  // namespace item3d
