#include "item3d/networks/diffusion/lora.h"

#include "item3d/core/config.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/adapter_file.h"
#include "item3d/networks/diffusion/lora_names.h"

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace item3d {
namespace {

const char* const another_model = "the LoRA was made for another model";

struct Network {
    std::string name;  ///< name in diffusers' metadata
    torch::OrderedDict<std::string, at::Tensor> parameters;
    LoraSpellings spellings;
};
using Networks = std::map<LoraNetwork, Network>;

Networks networks_of(const LoraTargets& targets) {
    Networks networks;
    networks[LoraNetwork::unet].name = "unet";
    networks[LoraNetwork::text_encoder].name = "text_encoder";
    networks[LoraNetwork::text_encoder_2].name = "text_encoder_2";
    const auto fill = [&](LoraNetwork which, const auto& model, const auto& spellings_of) {
        if (model.is_empty()) return;
        networks[which].parameters = model->named_parameters();
        networks[which].spellings = spellings_of(*model);
    };
    fill(LoraNetwork::unet, targets.unet, unet_spellings);
    fill(LoraNetwork::text_encoder, targets.text_encoder, text_encoder_spellings);
    fill(LoraNetwork::text_encoder_2, targets.text_encoder_2, text_encoder_spellings);
    return networks;
}

std::string shape_text(const at::Tensor& tensor) {
    return fmt::format("[{}]", fmt::join(tensor.sizes().vec(), ", "));
}

/// A network and the name of one of its modules.
using Place = std::pair<LoraNetwork, std::string>;
/// Names of one layer's tensors, by role.
using LayerTensors = std::map<LoraRole, std::string>;

/// The update factor * up x down, which is added to a weight.
struct Update {
    at::Tensor up;    ///< [out, rank]
    at::Tensor down;  ///< [rank, in x kernel]
    double factor;
};

/// Returns the tensors of each module. Throws InputError for a tensor that matches no module.
std::map<Place, LayerTensors> layers_of(const SafeTensors& file, const Networks& networks) {
    std::map<Place, LayerTensors> layers;
    std::set<std::string> embeddings;
    for (const std::string& name : file.names()) {
        if (const std::string word = bundled_embedding(name); !word.empty()) {
            embeddings.insert(word);
            continue;
        }
        const auto reject = [&](const std::string& problem, const std::string& hint) {
            throw InputError(file.path().string(), fmt::format("tensor '{}' {}", name, problem),
                             hint);
        };
        if (const std::string kind = other_adapter_kind(name); !kind.empty())
            reject("belongs to an adapter of the kind " + kind + ", which is not supported",
                   "use a plain LoRA");
        const std::optional<LoraTensorName> parsed = parse_lora_name(name);
        if (!parsed) reject("is not a LoRA tensor", "use a LoRA in .safetensors");
        const Network& network = networks.at(parsed->network);
        if (network.parameters.is_empty())
            reject(fmt::format("is for {}, which is missing in this model", network.name),
                   another_model);
        const std::optional<std::string> module = find_module(network.spellings, parsed->module);
        if (!module)
            reject(fmt::format("matches no layer in this model's {}", network.name), another_model);
        LayerTensors& layer = layers[{parsed->network, *module}];
        if (const auto [other, fresh] = layer.emplace(parsed->role, name); !fresh)
            reject(fmt::format("and '{}' are for the same layer", other->second),
                   "export the file again");
    }
    for (const std::string& word : embeddings)
        note(
            fmt::format("{}: its embedding '{}' is ignored (use --embedding with an embedding in a "
                        "separate file)",
                        file.path().string(), word));
    if (layers.empty())
        throw InputError(file.path().string(), "holds no tensor",
                         "choose the .safetensors file of a LoRA");
    return layers;
}

/// Alpha as recorded in PEFT's configuration, which is a file beside the weights, or in diffusers'
/// metadata. Alpha tensors have priority over it.
class RecordedAlpha {
  public:
    explicit RecordedAlpha(const SafeTensors& file) : file_(file) {
        const auto found = file.metadata().find("lora_adapter_metadata");
        if (found == file.metadata().end()) {
            const std::filesystem::path beside = file.path().parent_path() / "adapter_config.json";
            if (file.path().stem() != "adapter_model" || !std::filesystem::exists(beside)) return;
            const Config config = Config::read(beside);
            config.expect("peft_type", "LORA");
            record_ = config.json();
            return;
        }
        record_ = parse_json(found->second);
        if (!record_.is_object())
            throw InputError(file.path().string(), "its lora_adapter_metadata is not JSON",
                             "download the file again, or export it without this metadata");
    }
    /// Returns alpha / rank of a module; nullopt if alpha is not recorded.
    std::optional<double> factor(const std::string& network, const std::string& module,
                                 std::int64_t rank) const {
        if (value(network, "use_dora") == true)
            throw InputError(file_.path().string(),
                             "is an adapter of the kind DoRA, which is not supported",
                             "use a plain LoRA");
        nlohmann::json alpha = value(network, "lora_alpha");
        const nlohmann::json patterns = value(network, "alpha_pattern");
        if (patterns.is_object())
            for (const auto& [pattern, special] : patterns.items())
                if (module == pattern || module.ends_with("." + pattern)) alpha = special;
        if (alpha.is_null()) return std::nullopt;
        if (!alpha.is_number())
            throw InputError(file_.path().string(), "its lora_alpha is not a number",
                             "download the file again, or export it without this metadata");
        const auto size = static_cast<double>(rank);
        return alpha.get<double>() /
               (value(network, "use_rslora") == true ? std::sqrt(size) : size);
    }

  private:
    nlohmann::json value(const std::string& network, const std::string& key) const {
        if (!record_.is_object()) return nullptr;
        return record_.value(network + "." + key, record_.value(key, nlohmann::json()));
    }
    const SafeTensors& file_;
    nlohmann::json record_;
};

class LayerReader {
  public:
    LayerReader(const SafeTensors& file, double scale)
        : file_(file), recorded_(file), scale_(scale) {}

    /// Reads a layer's update and checks it against the weight.
    Update read(const LayerTensors& names, const std::string& network, const std::string& module,
                const at::Tensor& weight) const {
        for (const auto& [role, other] : names)
            if (names.count(LoraRole::down) == 0 || names.count(LoraRole::up) == 0)
                reject(other, fmt::format("has no matching tensor '{}'",
                                          names.count(LoraRole::down) ? "up" : "down"));
        const std::string& down_name = names.at(LoraRole::down);
        const std::string& up_name = names.at(LoraRole::up);
        const at::Tensor down = matrix(down_name), up = matrix(up_name);
        const std::int64_t rank = down.size(0);
        const at::Tensor up_flat = up.flatten(1), down_flat = down.flatten(1);
        if (up_flat.size(1) != rank)
            reject(up_name, fmt::format("of shape {} and '{}' of shape {} do not agree in rank",
                                        shape_text(up), down_name, shape_text(down)));
        const at::Tensor flat_weight = weight.flatten(1);
        if (up_flat.size(0) != flat_weight.size(0))
            reject(up_name, fmt::format("of shape {} does not fit a weight of shape {}",
                                        shape_text(up), shape_text(weight)));
        // A 1x1 convolution may be stored as a matrix, and vice versa.
        const bool same_kernel = down.sizes().slice(1) == weight.sizes().slice(1);
        const bool pointwise =
            flat_weight.size(1) == weight.size(1) && down_flat.size(1) == down.size(1);
        if (down_flat.size(1) != flat_weight.size(1) || !(same_kernel || pointwise))
            reject(down_name, fmt::format("of shape {} does not fit a weight of shape {}",
                                          shape_text(down), shape_text(weight)));
        return {up_flat, down_flat, scale_ * factor(names, network, module, rank)};
    }

  private:
    [[noreturn]] void reject(const std::string& tensor, const std::string& problem) const {
        throw InputError(file_.path().string(), fmt::format("tensor '{}' {}", tensor, problem),
                         another_model);
    }
    at::Tensor matrix(const std::string& name) const {
        const at::Tensor tensor = file_.tensor(name);
        if (!tensor.is_floating_point()) reject(name, "is not a floating-point tensor");
        if ((tensor.dim() != 2 && tensor.dim() != 4) || tensor.numel() == 0)
            reject(name, fmt::format("has shape {}, expected a matrix or a convolution",
                                     shape_text(tensor)));
        return tensor;
    }
    double factor(const LayerTensors& names, const std::string& network, const std::string& module,
                  std::int64_t rank) const {
        const auto found = names.find(LoraRole::alpha);
        if (found == names.end()) return recorded_.factor(network, module, rank).value_or(1.0);
        const at::Tensor alpha = file_.tensor(found->second);
        if (alpha.numel() != 1) reject(found->second, "is not a single number");
        const double value = alpha.to(at::kDouble).item<double>();
        if (!std::isfinite(value)) reject(found->second, "is not finite");
        return value / static_cast<double>(rank);
    }

    const SafeTensors& file_;
    RecordedAlpha recorded_;
    double scale_;
};

}  // namespace

void fuse_loras(const std::vector<LoraFile>& files, const LoraTargets& targets) {
    const at::NoGradGuard no_grad;
    std::vector<SafeTensors> adapters;
    for (const LoraFile& choice : files)
        adapters.push_back(open_adapter(choice.path));
    const Networks networks = networks_of(targets);
    const auto weight_of = [&](const Place& place) {
        return networks.at(place.first).parameters[place.second + ".weight"];
    };
    std::map<Place, std::vector<Update>> updates;
    for (std::size_t i = 0; i < files.size(); ++i) {
        const SafeTensors& file = adapters[i];
        const LayerReader reader(file, files[i].scale);
        for (const auto& [place, names] : layers_of(file, networks))
            updates[place].push_back(
                reader.read(names, networks.at(place.first).name, place.second, weight_of(place)));
    }
    for (const auto& [place, changes] : updates) {
        at::Tensor weight = weight_of(place);
        at::Tensor sum = weight.to(at::kFloat);
        for (const Update& change : changes) {
            const auto up = change.up.to(sum.device(), at::kFloat);
            const auto down = change.down.to(sum.device(), at::kFloat);
            sum = sum + change.factor * at::mm(up, down).reshape(weight.sizes());
        }
        weight.set_data(sum.to(weight.scalar_type()).contiguous(weight.suggest_memory_format()));
    }
}

}  // namespace item3d
