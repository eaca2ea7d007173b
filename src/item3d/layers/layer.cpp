#include "item3d/layers/layer.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/version.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

using nlohmann::json;

constexpr const char* layer_format = "item3d layer 1";
constexpr int largest_edge = 1 << 16;
constexpr std::array<const char*, 3> slot_names = {"base_color", "metallic_roughness", "normal"};
const std::string field_prefixes[] = {"fitted.", "field."};

const char* name_of(LayerSlot slot) {
    return slot_names[static_cast<std::size_t>(slot)];
}

std::string image_prefix(std::size_t image) {
    return fmt::format("picture.{}.", image);
}

std::string primitive_prefix(int primitive) {
    return fmt::format("primitive.{}.", primitive);
}

json size_json(const std::optional<LayerSize>& size) {
    return size ? json{size->first, size->second} : json();
}

std::optional<LayerSize> size_from(const json& from) {
    if (from.is_null()) return std::nullopt;
    return LayerSize(int_of(from.at(0)), int_of(from.at(1)));
}

json image_json(const LayerImage& image) {
    return {{"slot", name_of(image.slot)},
            {"size", {image.width, image.height, image.channels}},
            {"bits", image.bits},
            {"at", {image.x, image.y, image.channel}},
            {"texture", size_json(image.source_size)},
            {"occlusion_texture", size_json(image.occlusion_size)}};
}

json material_json(int index, const LayerMaterial& material) {
    const MaterialEdit& changes = material.changes;
    json result = {{"index", index},
                   {"name", material.name},
                   {"pictures", material.images},
                   {"keeps_orm_texels", changes.keeps_orm_texels},
                   {"keeps_texels", changes.keeps_texels},
                   {"includes_vertex_colors", changes.includes_vertex_colors},
                   {"keeps_occlusion", changes.keeps_occlusion},
                   {"removes_emission", changes.removes_emission},
                   {"makes_opaque", changes.makes_opaque},
                   {"removed_extensions", changes.removed_extensions}};
    if (material.uvs) result["uvs"] = *material.uvs;
    if (material.beginning) {
        const MaterialBeginning& beginning = *material.beginning;
        const Vec4& factor = beginning.base_color_factor;
        result["beginning"] = {{"base_color_texture", beginning.base_color_texture},
                               {"base_color_factor", {factor.x, factor.y, factor.z, factor.w}},
                               {"metallic_factor", beginning.metallic_factor}};
    }
    return result;
}

/// Returns a tensor of 32-bit integers.
at::Tensor to_tensor(const std::vector<std::uint32_t>& values) {
    return at::tensor(std::vector<std::int32_t>(values.begin(), values.end()), at::kInt);
}

std::vector<std::uint32_t> to_indices(const at::Tensor& tensor) {
    const auto* first = tensor.const_data_ptr<std::int32_t>();
    return {first, first + tensor.numel()};
}

class LayerReader {
  public:
    explicit LayerReader(const std::filesystem::path& path) : file_(SafeTensors::open(path)) {}

    EditLayer read() {
        const auto format = file_.metadata().find("format");
        const auto text = file_.metadata().find("layer");
        if (format == file_.metadata().end() || text == file_.metadata().end() ||
            !format->second.starts_with("item3d layer "))
            throw InputError(file_.path().string(), "is not a layer of an edit",
                             "give the layer.safetensors in the folder of an edit");
        if (format->second != layer_format)
            throw InputError(
                file_.path().string(),
                "has another version: '" + format->second + "', expected '" + layer_format + "'",
                "use the version of item3d that made it");
        EditLayer layer;
        layer.path = file_.path();
        try {
            read_header(parse_json_or_throw(text->second), layer);
        } catch (const json::exception&) {
            fail("its header is incomplete");
        }
        for (const std::string& name : file_.names()) {
            if (name.starts_with(field_prefixes[0]) || name.starts_with(field_prefixes[1]))
                layer.parameters.emplace_back(name, file_.tensor(name));
        }
        return layer;
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(file_.path().string(), problem,
                         "the file is damaged; make the edit again");
    }
    void require(bool condition, const std::string& what) const {
        if (!condition) fail(what + " does not fit the rest");
    }

    /// Returns an undefined tensor where the file has none.
    at::Tensor optional_tensor(const std::string& name) const {
        return file_.contains(name) ? file_.tensor(name) : at::Tensor();
    }

    void read_header(const json& header, EditLayer& layer) const {
        header.at("model").get_to(layer.model);
        header.at("model_hash").get_to(layer.model_hash);
        layer.settings = header.at("settings");
        if (header.contains("claim")) header.at("claim").get_to(layer.claim);
        layer.field = header.at("field");
        if (header.contains("channels")) {
            const json& channels = header.at("channels");
            layer.channels = {
                channels.at("base_color").get<bool>(), channels.at("occlusion").get<bool>(),
                channels.at("roughness").get<bool>(), channels.at("metallic").get<bool>(),
                channels.at("normal").get<bool>()};
        }
        if (header.contains("region")) {
            const json& region = header.at("region");
            layer.region = {region.at("include").get<std::vector<std::string>>(),
                            region.at("exclude").get<std::vector<std::string>>(),
                            region.at("feather").get<float>()};
        }
        for (const json& image : header.at("pictures"))
            layer.images.push_back(read_layer_image(image, layer.images.size()));
        for (const json& material : header.at("materials"))
            read_material(material, layer);
        for (const json& primitive : header.at("primitives")) {
            const int index = int_of(primitive.at("index"));
            require(index >= 0, "a primitive");
            layer.primitive_materials[index] = int_of(primitive.at("material"));
            layer.primitives[index] = read_primitive(index);
        }
    }

    LayerImage read_layer_image(const json& from, std::size_t index) const {
        LayerImage image;
        const auto slot =
            std::find(slot_names.begin(), slot_names.end(), from.at("slot").get<std::string>());
        require(slot != slot_names.end(), "an image's slot");
        image.slot = static_cast<LayerSlot>(slot - slot_names.begin());
        image.width = int_of(from.at("size").at(0));
        image.height = int_of(from.at("size").at(1));
        image.channels = int_of(from.at("size").at(2));
        image.bits = int_of(from.at("bits"));
        image.x = int_of(from.at("at").at(0));
        image.y = int_of(from.at("at").at(1));
        image.channel = int_of(from.at("at").at(2));
        image.source_size = size_from(from.at("texture"));
        image.occlusion_size = size_from(from.at("occlusion_texture"));
        const bool has_alpha = image.slot == LayerSlot::base_color && image.channels == 4;
        require(std::clamp(image.width, 1, largest_edge) == image.width &&
                    std::clamp(image.height, 1, largest_edge) == image.height &&
                    (image.channels == 3 || has_alpha) && (image.bits == 8 || image.bits == 16) &&
                    image.x >= 0 && image.y >= 0 && image.channel >= 0,
                "an image's size");
        const std::string prefix = image_prefix(index);
        image.change = optional_tensor(prefix + "change");
        image.source = optional_tensor(prefix + "source");
        image.mask = optional_tensor(prefix + "mask");
        if (const at::Tensor& change = image.change; change.defined()) {
            const bool is_integer = change.scalar_type() == at::kChar ||
                                    change.scalar_type() == at::kShort ||
                                    change.scalar_type() == at::kInt;
            require(is_integer && change.dim() == 3 && change.numel() > 0 &&
                        change.size(0) <= image.height - image.y &&
                        change.size(1) <= image.width - image.x &&
                        change.size(2) <= image.channels - image.channel,
                    prefix + "change");
        }
        const at::ScalarType type = image.bits > 8 ? at::kInt : at::kByte;
        require(!image.source.defined() ||
                    (image.source.scalar_type() == type &&
                     image.source.sizes() ==
                         at::IntArrayRef({image.height, image.width, image.channels})),
                prefix + "source");
        require(!image.mask.defined() ||
                    (image.mask.scalar_type() == at::kByte && image.mask.dim() == 2),
                prefix + "mask");
        return image;
    }

    void read_material(const json& from, EditLayer& layer) const {
        const int index = int_of(from.at("index"));
        LayerMaterial& material = layer.materials[index];
        from.at("name").get_to(material.name);
        for (std::size_t slot = 0; slot < material.images.size(); ++slot)
            material.images[slot] = int_of(from.at("pictures").at(slot));
        for (std::size_t slot = 0; slot < material.images.size(); ++slot) {
            const int image = material.images[slot];
            require(image >= -1 && image < static_cast<int>(layer.images.size()), "a material");
            require(image < 0 ||
                        layer.images[static_cast<std::size_t>(image)].slot == layer_slots[slot],
                    "a material");
        }
        require(index >= 0, "a material");
        MaterialEdit& changes = material.changes;
        from.at("keeps_orm_texels").get_to(changes.keeps_orm_texels);
        from.at("keeps_texels").get_to(changes.keeps_texels);
        from.at("includes_vertex_colors").get_to(changes.includes_vertex_colors);
        from.at("keeps_occlusion").get_to(changes.keeps_occlusion);
        from.at("removes_emission").get_to(changes.removes_emission);
        from.at("makes_opaque").get_to(changes.makes_opaque);
        from.at("removed_extensions").get_to(changes.removed_extensions);
        if (from.contains("uvs")) material.uvs = from.at("uvs").get<std::vector<double>>();
        if (!from.contains("beginning")) return;
        const json& beginning = from.at("beginning");
        material.beginning.emplace();
        material.beginning->base_color_texture = int_of(beginning.at("base_color_texture"));
        beginning.at("metallic_factor").get_to(material.beginning->metallic_factor);
        for (int c = 0; c < 4; ++c)
            material.beginning->base_color_factor[c] =
                beginning.at("base_color_factor").at(static_cast<std::size_t>(c)).get<float>();
    }

    PrimitiveEdit read_primitive(int index) const {
        const std::string prefix = primitive_prefix(index);
        const at::Tensor source = file_.tensor(prefix + "source_vertices");
        const at::Tensor uvs = file_.tensor(prefix + "uvs").contiguous();
        const at::Tensor indices = file_.tensor(prefix + "indices");
        require(source.scalar_type() == at::kInt && source.dim() == 1 &&
                    uvs.scalar_type() == at::kFloat && uvs.dim() == 2 && uvs.size(1) == 2 &&
                    uvs.size(0) == source.size(0) && indices.scalar_type() == at::kInt &&
                    indices.dim() == 1 && indices.size(0) % 3 == 0,
                prefix + "uvs");
        PrimitiveEdit edit{to_indices(source), {}, to_indices(indices)};
        const auto* values = uvs.const_data_ptr<float>();
        for (std::int64_t i = 0; i < uvs.size(0); ++i)
            edit.uvs.emplace_back(values[2 * i], values[2 * i + 1]);
        require(std::all_of(values, values + uvs.numel(), [](float v) { return std::isfinite(v); }),
                prefix + "uvs");
        const auto count = edit.uvs.size();
        require(std::all_of(edit.indices.begin(), edit.indices.end(),
                            [&](std::uint32_t vertex) { return vertex < count; }),
                prefix + "indices");
        return edit;
    }

    SafeTensors file_;
};

}  // namespace

void save_layer(const std::filesystem::path& path, const EditLayer& layer) {
    NamedTensors tensors = layer.parameters;
    json images = json::array(), materials = json::array(), primitives = json::array();
    for (std::size_t i = 0; i < layer.images.size(); ++i) {
        const LayerImage& image = layer.images[i];
        images.push_back(image_json(image));
        const auto add = [&](const char* name, const at::Tensor& tensor) {
            if (tensor.defined()) tensors.emplace_back(image_prefix(i) + name, tensor);
        };
        add("change", image.change);
        add("source", image.source);
        add("mask", image.mask);
    }
    for (const auto& [index, material] : layer.materials)
        materials.push_back(material_json(index, material));
    for (const auto& [index, edit] : layer.primitives) {
        primitives.push_back({{"index", index}, {"material", layer.primitive_materials.at(index)}});
        const std::string prefix = primitive_prefix(index);
        std::vector<float> uvs;
        for (const Vec2& uv : edit.uvs)
            uvs.insert(uvs.end(), {uv.x, uv.y});
        tensors.emplace_back(prefix + "source_vertices", to_tensor(edit.source_vertices));
        tensors.emplace_back(prefix + "uvs", at::tensor(uvs, at::kFloat).view({-1, 2}));
        tensors.emplace_back(prefix + "indices", to_tensor(edit.indices));
    }
    json header = {{"version", version()},
                   {"model", layer.model},
                   {"model_hash", layer.model_hash},
                   {"settings", layer.settings},
                   {"field", layer.field},
                   {"pictures", std::move(images)},
                   {"materials", std::move(materials)},
                   {"primitives", std::move(primitives)}};
    if (layer.channels) {
        const BakedChannels& channels = *layer.channels;
        header["channels"] = {{"base_color", channels.base_color},
                              {"occlusion", channels.occlusion},
                              {"roughness", channels.roughness},
                              {"metallic", channels.metallic},
                              {"normal", channels.normal}};
    }
    if (layer.claim != EditClaim()) header["claim"] = layer.claim;
    if (layer.region)
        header["region"] = {{"include", layer.region->include},
                            {"exclude", layer.region->exclude},
                            {"feather", layer.region->feather}};
    save_safetensors(path, tensors,
                     {{"format", layer_format},
                      {"layer", header.dump(-1, ' ', false, json::error_handler_t::replace)}});
}

EditLayer load_layer(const std::filesystem::path& path) {
    return LayerReader(path).read();
}

}  // namespace item3d
