// Command item3d tensors: writes a model's triangles, materials and textures as a safetensors file.
#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/model_options.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/io/load.h"
#include "item3d/render/image_tensor.h"
#include "item3d/tensors/safetensors.h"

#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace item3d {
namespace {

struct TensorsCommand : CommonOptions {
    std::string model;
    std::filesystem::path output;
    LoadOptions load;
};

/// Copies a list of vectors of floats to [N, components].
template <typename Vector>
at::Tensor rows_of(const std::vector<Vector>& values) {
    constexpr std::int64_t components = sizeof(Vector) / sizeof(float);
    at::Tensor rows = at::empty({static_cast<std::int64_t>(values.size()), components}, at::kFloat);
    std::copy(values.begin(), values.end(), static_cast<Vector*>(rows.mutable_data_ptr()));
    return rows;
}

template <typename Vector>
nlohmann::json numbers_of(const Vector& vector) {
    nlohmann::json numbers = nlohmann::json::array();
    for (int i = 0; i < vector.length(); ++i)
        numbers.push_back(vector[i]);
    return numbers;
}

at::Tensor triangles_of(const Primitive& primitive) {
    at::Tensor triangles =
        at::empty({static_cast<std::int64_t>(primitive.indices.size() / 3), 3}, at::kInt);
    std::copy(primitive.indices.begin(), primitive.indices.end(),
              static_cast<std::int32_t*>(triangles.mutable_data_ptr()));
    return triangles;
}

NamedTensors tensors_of(const Model& model) {
    NamedTensors all;
    for (std::size_t i = 0; i < model.primitives.size(); ++i) {
        const Primitive& primitive = model.primitives[i];
        const auto add = [&](const char* name, const at::Tensor& values) {
            if (values.size(0) > 0)
                all.emplace_back(fmt::format("primitives.{}.{}", i, name), values);
        };
        add("positions", rows_of(primitive.positions));
        add("normals", rows_of(primitive.normals));
        add("uvs", rows_of(primitive.uvs));
        for (std::size_t map = 0; map < primitive.further_uvs.size(); ++map)
            add(fmt::format("uvs_{}", map + 1).c_str(), rows_of(primitive.further_uvs[map]));
        add("tangents", rows_of(primitive.tangents));
        add("colors", rows_of(primitive.colors));
        add("triangles", triangles_of(primitive));
    }
    for (std::size_t i = 0; i < model.textures.size(); ++i)
        all.emplace_back(fmt::format("textures.{}", i), to_tensor(model.textures[i].image));
    return all;
}

nlohmann::json material_json(const Material& material) {
    const auto alpha = material.alpha == Material::Alpha::opaque ? "opaque"
                       : material.alpha == Material::Alpha::mask ? "mask"
                                                                 : "blend";
    return {{"name", material.name},
            {"base_color_factor", numbers_of(material.base_color_factor)},
            {"base_color_texture", material.base_color_texture},
            {"metallic_factor", material.metallic_factor},
            {"roughness_factor", material.roughness_factor},
            {"metallic_roughness_texture", material.metallic_roughness_texture},
            {"metallic_roughness_uvs", material.metallic_roughness_uvs},
            {"occlusion_texture", material.occlusion_texture},
            {"occlusion_uvs", material.occlusion_uvs},
            {"occlusion_strength", material.occlusion_strength},
            {"normal_texture", material.normal_texture},
            {"normal_uvs", material.normal_uvs},
            {"normal_scale", material.normal_scale},
            {"emissive_factor", numbers_of(material.emissive_factor)},
            {"emissive_texture", material.emissive_texture},
            {"emissive_uvs", material.emissive_uvs},
            {"alpha", alpha},
            {"alpha_cutoff", material.alpha_cutoff},
            {"double_sided", material.double_sided},
            {"unlit", material.unlit}};
}

nlohmann::json describe(const Model& model) {
    nlohmann::json primitives = nlohmann::json::array(), materials = nlohmann::json::array(),
                   textures = nlohmann::json::array();
    for (const Primitive& primitive : model.primitives)
        primitives.push_back({{"name", primitive.name}, {"material", primitive.material}});
    for (const Material& material : model.materials)
        materials.push_back(material_json(material));
    const auto name_of = [](Wrap wrap) {
        return wrap == Wrap::repeat            ? "repeat"
               : wrap == Wrap::mirrored_repeat ? "mirrored_repeat"
                                               : "clamp_to_edge";
    };
    for (const Texture& texture : model.textures)
        textures.push_back({{"name", texture.name},
                            {"wrap_u", name_of(texture.wrap_u)},
                            {"wrap_v", name_of(texture.wrap_v)}});
    return {{"name", model.name},
            {"primitives", primitives},
            {"materials", materials},
            {"textures", textures}};
}

void run_tensors(const TensorsCommand& command) {
    if (command.output.extension() != ".safetensors")
        throw UsageError(fmt::format("-o {}: expected the name of a .safetensors file",
                                     command.output.string()));
    const Model model = load_model(command.model, command.load);
    make_folder_of(command.output);
    save_safetensors(command.output, tensors_of(model));
    if (command.json) {
        nlohmann::json result = describe(model);
        result["file"] = command.output.string();
        print_json(result);
    } else {
        fmt::print("{}\n", command.output.string());
    }
}

}  // namespace

void add_tensors_command(CLI::App& app) {
    auto options = std::make_shared<TensorsCommand>();
    CLI::App* command = add_command(app, "tensors", *options);
    command->add_option("MODEL", options->model, "A " + model_extensions_text() + " file")
        ->required();
    command
        ->add_option("-o,--output", options->output,
                     "A .safetensors file: positions, normals, uvs, tangents, colors and triangles "
                     "of each primitive in world space, and textures; --json adds the materials")
        ->type_name("FILE")
        ->required();
    command
        ->add_option("--variant", options->load.variant,
                     "Appearance variant to take, by name. Without it: the default materials")
        ->type_name("NAME");
    add_texture_folders(*command, options->load.texture_folders);
    command->callback([options] {
        start_command(*options);
        run_tensors(*options);
    });
}

}  // namespace item3d
