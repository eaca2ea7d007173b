#include "item3d/networks/diffusion/unet_config.h"

#include <cmath>

namespace item3d {
namespace {

/// Returns one number if all values are equal, else a list. The layout allows both.
nlohmann::json shortest(const std::vector<int>& values) {
    for (const int value : values)
        if (value != values[0]) return values;
    return values[0];
}

void check_block_types(const Config& config, const char* key, const std::vector<std::string>& types,
                       const std::string& plain, const std::string& crossing, std::size_t count) {
    if (types.size() != count) config.fail(key, std::to_string(count) + " block types");
    for (const std::string& type : types)
        if (type != plain && type != crossing) config.fail(key, plain + " or " + crossing);
}

/// Throws InputError for options of the layout that no supported model uses.
void check_unsupported(const Config& config) {
    config.expect("act_fn", "silu");
    config.expect("attention_type", "default");
    config.expect("class_embed_type", nullptr);
    config.expect("class_embeddings_concat", false);
    config.expect("conv_in_kernel", 3);
    config.expect("conv_out_kernel", 3);
    config.expect("cross_attention_norm", nullptr);
    config.expect("dual_cross_attention", false);
    config.expect("encoder_hid_dim", nullptr);
    config.expect("encoder_hid_dim_type", nullptr);
    config.expect("mid_block_only_cross_attention", false);
    config.expect("mid_block_type", "UNetMidBlock2DCrossAttn");
    config.expect("num_class_embeds", nullptr);
    config.expect("resnet_out_scale_factor", 1.0);
    config.expect("resnet_skip_time_act", false);
    config.expect("resnet_time_scale_shift", "default");
    config.expect("reverse_transformer_layers_per_block", nullptr);
    config.expect("time_cond_proj_dim", nullptr);
    config.expect("time_embedding_act_fn", nullptr);
    config.expect("time_embedding_dim", nullptr);
    config.expect("time_embedding_type", "positional");
    config.expect("timestep_post_act", nullptr);
    if (config.has("only_cross_attention")) {
        const auto& value = config.json().at("only_cross_attention");
        for (const auto& entry : value.is_array() ? value : nlohmann::json::array({value}))
            if (entry != false) config.fail("only_cross_attention", "false");
    }
}

}  // namespace

void UNetEncoderConfig::read(const Config& config) {
    check_unsupported(config);
    in_channels = config.size("in_channels", 4);
    block_out_channels = config.sizes("block_out_channels", block_out_channels);
    const std::size_t count = block_out_channels.size();
    if (count > 8) config.fail("block_out_channels", "at most 8 blocks");
    down_block_types = config.texts("down_block_types", down_block_types);
    check_block_types(config, "down_block_types", down_block_types, "DownBlock2D",
                      "CrossAttnDownBlock2D", count);
    layers_per_block = config.sizes("layers_per_block", {2}, count);
    transformer_layers_per_block = config.sizes("transformer_layers_per_block", {1}, count);
    cross_attention_dim = config.sizes("cross_attention_dim", {1280}, count);
    // diffusers falls back from num_attention_heads to attention_head_dim, although that name is
    // wrong, because published configs rely on it.
    const char* heads =
        config.has("num_attention_heads") ? "num_attention_heads" : "attention_head_dim";
    attention_head_dim = config.sizes(heads, {8}, count);
    norm_num_groups = config.size("norm_num_groups", 32);
    norm_eps = config.number("norm_eps", 1e-5);
    use_linear_projection = config.boolean("use_linear_projection", false);
    flip_sin_to_cos = config.boolean("flip_sin_to_cos", true);
    freq_shift = config.number("freq_shift", 0);
    downsample_padding = config.integer("downsample_padding", 1);
    if (downsample_padding != 0 && downsample_padding != 1)
        config.fail("downsample_padding", "0 or 1");
    mid_block_scale_factor = config.number("mid_block_scale_factor", 1);
    addition_embed_type = config.text("addition_embed_type", "");
    if (addition_embed_type == "text_time") {
        addition_time_embed_dim = config.size("addition_time_embed_dim", 0);
        projection_class_embeddings_input_dim =
            config.size("projection_class_embeddings_input_dim", 0);
    } else if (!addition_embed_type.empty()) {
        config.fail("addition_embed_type", "null or \"text_time\"");
    }

    for (std::size_t i = 0; i < count; ++i) {
        const int channels = block_out_channels[i];
        if (channels > 16384) config.fail("block_out_channels", "at most 16384 channels");
        if (layers_per_block[i] > 16) config.fail("layers_per_block", "at most 16");
        if (transformer_layers_per_block[i] > 64)
            config.fail("transformer_layers_per_block", "at most 64");
        if (channels % norm_num_groups != 0)
            config.fail("norm_num_groups", "a divisor of every block's channels");
        if (channels % attention_head_dim[i] != 0)
            config.fail(heads, "divisors of the blocks' channels (they are numbers of heads)");
    }
    if (block_out_channels[0] % 2 != 0)
        config.fail("block_out_channels", "an even first entry (it is the time embedding's width)");
    if (count > 1 && freq_shift >= block_out_channels[0] / 2)
        config.fail("freq_shift", "less than half of the first block's channels");
}

UNet2DConditionConfig UNet2DConditionConfig::from_json(const nlohmann::json& json,
                                                       const std::string& subject) {
    return from_config(Config(json, subject));
}

UNet2DConditionConfig UNet2DConditionConfig::from_config(const Config& config) {
    if (config.text("_class_name", "UNet2DConditionModel") != "UNet2DConditionModel")
        config.fail("_class_name", "UNet2DConditionModel");
    UNet2DConditionConfig result;
    result.read(config);
    if (config.has("sample_size"))  // [height, width] or one number
        result.sample_size = config.sizes("sample_size", {64})[0];
    result.out_channels = config.size("out_channels", 4);
    result.up_block_types = config.texts("up_block_types", result.up_block_types);
    check_block_types(config, "up_block_types", result.up_block_types, "UpBlock2D",
                      "CrossAttnUpBlock2D", result.block_out_channels.size());
    result.center_input_sample = config.boolean("center_input_sample", false);
    return result;
}

nlohmann::json UNet2DConditionConfig::to_json() const {
    nlohmann::json json = {
        {"_class_name", "UNet2DConditionModel"},
        {"act_fn", "silu"},
        {"attention_head_dim", attention_head_dim},
        {"block_out_channels", block_out_channels},
        {"center_input_sample", center_input_sample},
        {"cross_attention_dim", shortest(cross_attention_dim)},
        {"down_block_types", down_block_types},
        {"downsample_padding", downsample_padding},
        {"dual_cross_attention", false},
        {"flip_sin_to_cos", flip_sin_to_cos},
        {"freq_shift", freq_shift},
        {"in_channels", in_channels},
        {"layers_per_block", shortest(layers_per_block)},
        {"mid_block_scale_factor", mid_block_scale_factor},
        {"mid_block_type", "UNetMidBlock2DCrossAttn"},
        {"norm_eps", norm_eps},
        {"norm_num_groups", norm_num_groups},
        {"only_cross_attention", false},
        {"out_channels", out_channels},
        {"sample_size", sample_size},
        {"transformer_layers_per_block", shortest(transformer_layers_per_block)},
        {"up_block_types", up_block_types},
        {"use_linear_projection", use_linear_projection},
    };
    if (freq_shift == std::floor(freq_shift)) json["freq_shift"] = static_cast<int>(freq_shift);
    if (!addition_embed_type.empty()) {
        json["addition_embed_type"] = addition_embed_type;
        json["addition_time_embed_dim"] = addition_time_embed_dim;
        json["projection_class_embeddings_input_dim"] = projection_class_embeddings_input_dim;
    }
    return json;
}

double UNetEncoderConfig::min_parameters() const {
    double total = 0;
    for (int i = 0; i < blocks(); ++i) {
        const double channels = block_out_channels[i];
        // Each level has at least a 3x3 convolution for each resnet of the down path.
        total += 9.0 * channels * channels * layers_per_block[i];
        if (down_block_types[i] == "CrossAttnDownBlock2D")
            total += 16.0 * channels * channels * transformer_layers_per_block[i];
    }
    return total;
}

}  // namespace item3d
