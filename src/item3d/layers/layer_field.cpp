#include "item3d/layers/layer_field.h"

#include "item3d/core/error.h"

namespace item3d {
namespace {

using nlohmann::json;

json options_json(const NeuralTextureOptions& options) {
    const auto corner = [&](int i) {
        const Vec3& at = options.bounds[static_cast<std::size_t>(i)];
        return json{at.x, at.y, at.z};
    };
    const MaterialRanges& ranges = options.ranges;
    return {{"levels", options.levels},
            {"features", options.features},
            {"log2_table_size", options.log2_table_size},
            {"base_resolution", options.base_resolution},
            {"finest_resolution", options.finest_resolution},
            {"hidden_width", options.hidden_width},
            {"bounds", {corner(0), corner(1)}},
            {"ranges",
             {{"base_color", ranges.base_color},
              {"occlusion", ranges.occlusion},
              {"roughness", ranges.roughness},
              {"metallic", ranges.metallic},
              {"normal_slope", ranges.normal_slope}}}};
}

/// Reads the options of a neural texture. Throws json::exception if they are damaged.
NeuralTextureOptions options_of(const json& from) {
    NeuralTextureOptions options;
    from.at("levels").get_to(options.levels);
    from.at("features").get_to(options.features);
    from.at("log2_table_size").get_to(options.log2_table_size);
    from.at("base_resolution").get_to(options.base_resolution);
    from.at("finest_resolution").get_to(options.finest_resolution);
    from.at("hidden_width").get_to(options.hidden_width);
    for (std::size_t i = 0; i < 2; ++i)
        for (int axis = 0; axis < 3; ++axis)
            options.bounds[i][axis] =
                from.at("bounds").at(i).at(static_cast<std::size_t>(axis)).get<float>();
    const json& ranges = from.at("ranges");
    ranges.at("base_color").get_to(options.ranges.base_color);
    ranges.at("occlusion").get_to(options.ranges.occlusion);
    ranges.at("roughness").get_to(options.ranges.roughness);
    ranges.at("metallic").get_to(options.ranges.metallic);
    ranges.at("normal_slope").get_to(options.ranges.normal_slope);
    return options;
}

bool is_sane(const NeuralTextureOptions& options) {
    const auto between = [](int value, int low, int high) { return value >= low && value <= high; };
    return between(options.levels, 1, 32) && between(options.features, 1, 16) &&
           between(options.log2_table_size, 1, 24) && between(options.base_resolution, 1, 4096) &&
           between(options.finest_resolution, options.base_resolution, 1 << 16) &&
           between(options.hidden_width, 1, 1024);
}

}  // namespace

void put_fields(const EditFields& fields, EditLayer& layer) {
    layer.field = options_json(fields.fitted->options());
    layer.parameters.clear();
    at::Tensor before;
    for (const auto& [name, parameter] : fields.fitted->named_parameters()) {
        layer.parameters.emplace_back("fitted." + name, parameter.detach().cpu().to(at::kHalf));
        if (name == "table") before = layer.parameters.back().second;
    }
    for (const auto& [name, parameter] : fields.field->named_parameters()) {
        const at::Tensor half = parameter.detach().cpu().to(at::kHalf);
        if (name != "table") {
            layer.parameters.emplace_back("field." + name, half);
            continue;
        }
        const at::Tensor rows = half.ne(before).any(1).nonzero().select(1, 0);
        layer.parameters.emplace_back("field.rows", rows.to(at::kInt));
        layer.parameters.emplace_back("field.values", half.index_select(0, rows));
    }
}

EditFields get_fields(const EditLayer& layer) {
    const at::NoGradGuard no_grad;
    const auto fail = [&](const std::string& problem) {
        throw InputError(layer.path.string(), problem, "the file is damaged; make the edit again");
    };
    NeuralTextureOptions options;
    try {
        options = options_of(layer.field);
    } catch (const json::exception&) {
        fail("its neural texture has invalid options");
    }
    if (!is_sane(options)) fail("its neural texture has options out of range");
    EditFields fields{NeuralTexture(options), NeuralTexture(options)};
    const auto find = [&](const std::string& name) {
        for (const auto& [own, tensor] : layer.parameters)
            if (own == name) return tensor;
        fail("has no tensor " + name);
        return at::Tensor();
    };
    const auto copy = [&](const std::string& name, at::Tensor target) {
        const at::Tensor saved = find(name);
        if (saved.sizes() != target.sizes()) fail("tensor " + name + " has another shape");
        target.copy_(saved);
    };
    for (const auto& [name, parameter] : fields.fitted->named_parameters())
        copy("fitted." + name, parameter);
    for (const auto& [name, parameter] : fields.field->named_parameters()) {
        if (name != "table") {
            copy("field." + name, parameter);
            continue;
        }
        parameter.copy_(fields.fitted->table());
        const at::Tensor rows = find("field.rows").to(at::kLong);
        const at::Tensor values = find("field.values").to(at::kFloat);
        const bool fits =
            rows.dim() == 1 && values.dim() == 2 && values.size(0) == rows.size(0) &&
            values.size(1) == parameter.size(1) &&
            (rows.numel() == 0 || (rows.min().item<std::int64_t>() >= 0 &&
                                   rows.max().item<std::int64_t>() < parameter.size(0)));
        if (!fits) fail("rows of its neural texture do not fit");
        parameter.detach().index_copy_(0, rows, values);
    }
    return fields;
}

}  // namespace item3d
