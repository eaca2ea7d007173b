#include "item3d/networks/diffusion/lora_names.h"

#include "item3d/core/format.h"

#include <algorithm>
#include <array>
#include <functional>
#include <sstream>
#include <utility>
#include <vector>

namespace item3d {
namespace {

constexpr std::array<std::pair<const char*, LoraRole>, 13> endings = {{
    {".lora_A.weight", LoraRole::down},
    {".lora_B.weight", LoraRole::up},
    {".lora_A.default.weight", LoraRole::down},
    {".lora_B.default.weight", LoraRole::up},
    {".lora.down.weight", LoraRole::down},
    {".lora.up.weight", LoraRole::up},
    {".lora_linear_layer.down.weight", LoraRole::down},
    {".lora_linear_layer.up.weight", LoraRole::up},
    {".lora_down.weight", LoraRole::down},
    {".lora_up.weight", LoraRole::up},
    {"_lora.down.weight", LoraRole::down},
    {"_lora.up.weight", LoraRole::up},
    {".alpha", LoraRole::alpha},
}};

constexpr std::array<std::pair<const char*, LoraNetwork>, 9> beginnings = {{
    {"model.diffusion_model.", LoraNetwork::unet},
    {"diffusion_model.", LoraNetwork::unet},
    {"unet.", LoraNetwork::unet},
    {"text_encoder.", LoraNetwork::text_encoder},
    {"text_encoder_2.", LoraNetwork::text_encoder_2},
    {"lora_unet_", LoraNetwork::unet},
    {"lora_te_", LoraNetwork::text_encoder},
    {"lora_te1_", LoraNetwork::text_encoder},
    {"lora_te2_", LoraNetwork::text_encoder_2},
}};

constexpr std::array<std::pair<const char*, const char*>, 8> other_kinds = {{
    {".hada_", "LoHa"},
    {".lokr_", "LoKr"},
    {".dora_scale", "DoRA"},
    {".lora_magnitude_vector", "DoRA"},
    {".oft_", "OFT"},
    {".lora_mid.", "LoCon with a Tucker core"},
    {".ia3_", "IA3"},
    {".on_input", "IA3"},
}};

/// Removes the prefix `beginning`. Returns false if it is missing.
bool cut_beginning(std::string& text, const std::string& beginning) {
    if (!text.starts_with(beginning)) return false;
    text.erase(0, beginning.size());
    return true;
}

std::string flat(std::string name) {
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

std::vector<std::string> split_at_dots(const std::string& name) {
    std::vector<std::string> parts;
    std::istringstream stream(name);
    for (std::string part; std::getline(stream, part, '.');)
        parts.push_back(part);
    return parts;
}

std::string replace_once(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

/// Returns the modules with a weight of at least two dimensions.
std::vector<std::string> matrix_modules(const torch::nn::Module& network) {
    const std::string ending = ".weight";
    std::vector<std::string> modules;
    for (const auto& parameter : network.named_parameters()) {
        const std::string& name = parameter.key();
        if (name.ends_with(ending) && parameter.value().dim() >= 2)
            modules.push_back(name.substr(0, name.size() - ending.size()));
    }
    return modules;
}

/// Names in the original Stable Diffusion code, where an entry of "input_blocks" or "output_blocks"
/// is a resnet with the attention after it, or a downsampler.
class OriginalNames {
  public:
    explicit OriginalNames(const UNet2DConditionConfig& config) : config_(config) {}

    /// Returns the original name of a module; "" if it has none.
    std::string of(const std::string& module) const {
        static const std::map<std::string, std::string> single = {
            {"conv_in", "input_blocks_0_0"},
            {"time_embedding.linear_1", "time_embed_0"},
            {"time_embedding.linear_2", "time_embed_2"},
            {"add_embedding.linear_1", "label_emb_0_0"},
            {"add_embedding.linear_2", "label_emb_0_2"},
            {"conv_out", "out_2"},
        };
        if (const auto found = single.find(module); found != single.end()) return found->second;
        const std::vector<std::string> parts = split_at_dots(module);
        if (parts[0] == "mid_block") {
            const int place = parts[1] == "attentions" ? 1 : 2 * std::stoi(parts[2]);
            return fmt::format("middle_block_{}_{}", place, rest(parts, 3));
        }
        if (parts[0] == "down_blocks") return of_down(parts);
        if (parts[0] == "up_blocks") return of_up(parts);
        return "";
    }

  private:
    std::string of_down(const std::vector<std::string>& parts) const {
        const int block = std::stoi(parts[1]), layer = std::stoi(parts[3]);
        int first = 1;
        for (int i = 0; i < block; ++i)
            first += config_.layers_per_block[i] + 1;
        if (parts[2] == "downsamplers")
            return fmt::format("input_blocks_{}_0_op", first + config_.layers_per_block[block]);
        return fmt::format("input_blocks_{}_{}_{}", first + layer, parts[2] == "attentions" ? 1 : 0,
                           rest(parts, 4));
    }
    std::string of_up(const std::vector<std::string>& parts) const {
        const int block = std::stoi(parts[1]), layer = std::stoi(parts[3]);
        const auto layers = [&](int up_block) {
            return config_.layers_per_block[config_.blocks() - 1 - up_block] + 1;
        };
        int first = 0;
        for (int i = 0; i < block; ++i)
            first += layers(i);
        if (parts[2] == "upsamplers") {
            const bool crossing = config_.up_block_types[block] == "CrossAttnUpBlock2D";
            return fmt::format("output_blocks_{}_{}_conv", first + layers(block) - 1,
                               crossing ? 2 : 1);
        }
        return fmt::format("output_blocks_{}_{}_{}", first + layer,
                           parts[2] == "attentions" ? 1 : 0, rest(parts, 4));
    }
    /// Returns the rest of a name after the layer, with the original names of a resnet's parts.
    static std::string rest(const std::vector<std::string>& parts, std::size_t first) {
        static const std::map<std::string, std::string> resnet = {
            {"conv1", "in_layers_2"},
            {"time_emb_proj", "emb_layers_1"},
            {"conv2", "out_layers_3"},
            {"conv_shortcut", "skip_connection"},
        };
        if (const auto found = resnet.find(parts[first]); found != resnet.end())
            return found->second;
        std::string joined;
        for (std::size_t i = first; i < parts.size(); ++i)
            joined += (i > first ? "_" : "") + parts[i];
        return joined;
    }

    const UNet2DConditionConfig& config_;
};

}  // namespace

std::optional<LoraTensorName> parse_lora_name(const std::string& name) {
    for (const auto& [ending, role] : endings) {
        if (!name.ends_with(ending)) continue;
        LoraTensorName result{LoraNetwork::unet,
                              name.substr(0, name.size() - std::string(ending).size()), role};
        cut_beginning(result.module, "base_model.model.");
        for (const auto& [beginning, network] : beginnings) {
            if (!cut_beginning(result.module, beginning)) continue;
            result.network = network;
            break;
        }
        cut_beginning(result.module, "base_model.model.");
        return result;
    }
    return std::nullopt;
}

std::optional<std::string> find_module(const LoraSpellings& spellings, const std::string& name) {
    for (const std::string& spelling : {name, flat(name)}) {
        const auto found = spellings.find(spelling);
        if (found != spellings.end()) return found->second;
    }
    return std::nullopt;
}

std::string bundled_embedding(const std::string& name) {
    std::string rest = name;
    if (!cut_beginning(rest, "bundle_emb.")) return "";
    return rest.substr(0, rest.find('.'));
}

std::string other_adapter_kind(const std::string& name) {
    for (const auto& [part, kind] : other_kinds)
        if (name.find(part) != std::string::npos) return kind;
    return name.ends_with(".diff") || name.ends_with(".diff_b") ? "weight differences" : "";
}

LoraSpellings unet_spellings(const UNet2DConditionImpl& unet) {
    const OriginalNames original(unet.config());
    LoraSpellings spellings;
    for (const std::string& module : matrix_modules(unet)) {
        spellings[module] = module;
        spellings[flat(module)] = module;
        if (const std::string name = original.of(module); !name.empty()) spellings[name] = module;
        // Early diffusers attached LoRA to attention processors: "attn1.processor.to_out".
        const std::string processor = replace_once(module, ".to_", ".processor.to_");
        if (processor != module)
            spellings[processor.ends_with(".to_out.0") ? processor.substr(0, processor.size() - 2)
                                                       : processor] = module;
    }
    return spellings;
}

LoraSpellings text_encoder_spellings(const ClipTextModelImpl& text_encoder) {
    static constexpr std::array<std::pair<const char*, const char*>, 4> early = {
        {{".q_proj", ".to_q"},
         {".k_proj", ".to_k"},
         {".v_proj", ".to_v"},
         {".out_proj", ".to_out"}}};
    LoraSpellings spellings;
    for (const std::string& module : matrix_modules(text_encoder)) {
        for (const std::string& name : {module, "text_model." + module}) {
            spellings[name] = module;
            spellings[flat(name)] = module;
            for (const auto& [now, before] : early)
                if (name.ends_with(now)) spellings[replace_once(name, now, before)] = module;
        }
    }
    return spellings;
}

}  // namespace item3d
