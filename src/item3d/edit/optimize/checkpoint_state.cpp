#include "item3d/edit/optimize/checkpoint_state.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/tensors/checkpoint.h"

namespace item3d {
namespace {

std::filesystem::path checkpoint_path(const EditRequest& request) {
    return request.checkpoint.empty() ? request.output / "checkpoint.safetensors"
                                      : request.checkpoint;
}

nlohmann::json identity_of(const EditRequest& request, const EditState& state) {
    nlohmann::json identity = request.plan;
    identity["model"] = hash_of_file(request.model);
    identity["prior_weights"] = state.prior_weights;
    identity["precision"] = request.precision;
    if (request.plan.method == "clip")
        identity["teacher"] = (request.teacher.empty() ? request.clip : request.teacher).string();
    if (!request.inpainting.empty()) identity["inpainting"] = request.inpainting.string();
    if (request.plan.method == "in2n" && !request.instruct.empty())
        identity["instruct"] = request.instruct.string();
    if (request.plan.asks_captioner) identity["captioner"] = request.captioner.string();
    return identity;
}

/// Appends the record: its text as a tensor of bytes, and its images as one tensor.
void append_adjustment(NamedTensors& tensors, const AdjustmentState& adjustment) {
    nlohmann::json before = nlohmann::json::array();
    for (const Caption& caption : adjustment.captions_before)
        before.push_back({{"text", caption.text}, {"ended", caption.ended}});
    const nlohmann::json json = {
        {"records", adjustment.records}, {"before", before}, {"failure", adjustment.failure}};
    const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    tensors.emplace_back("adjustment.json",
                         at::tensor(std::vector<std::uint8_t>(text.begin(), text.end())));
    std::vector<at::Tensor> images;
    for (const AdjustmentRecord& record : adjustment.records)
        images.push_back(record.image);
    if (!images.empty()) tensors.emplace_back("adjustment.pictures", at::stack(images));
}

void read_adjustment(const CheckpointReader& reader, AdjustmentState& adjustment) {
    const at::Tensor bytes = reader.get("adjustment.json").contiguous();
    const auto* text = bytes.const_data_ptr<std::uint8_t>();
    const auto json = nlohmann::json::parse(text, text + bytes.numel());
    json.at("records").get_to(adjustment.records);
    json.at("failure").get_to(adjustment.failure);
    for (const auto& caption : json.at("before"))
        adjustment.captions_before.push_back(
            {caption.at("text").get<std::string>(), caption.at("ended").get<bool>()});
    for (std::size_t i = 0; i < adjustment.records.size(); ++i)
        adjustment.records[i].image =
            reader.get("adjustment.pictures")[static_cast<std::int64_t>(i)];
}

std::vector<float> to_floats(const at::Tensor& tensor) {
    const at::Tensor flat = tensor.contiguous();
    return {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()};
}

void append_field(NamedTensors& tensors, const EditState& state) {
    append_parameters(tensors, "fitted.", state.fitted->named_parameters());
    append_parameters(tensors, "field.", state.field->named_parameters());
    if (state.light) append_parameters(tensors, "light.", state.light->named_parameters());
    for (const auto& [name, tensor] : state.optimizer.state()) {
        tensors.emplace_back("optimizer." + name, tensor);
    }
    for (const auto& [name, tensor] : state.guidance->state()) {
        tensors.emplace_back("guidance." + name, tensor);
    }
    if (state.detail.has_begun()) {
        append_parameters(tensors, "detail.before.", state.detail.before->named_parameters());
        for (const auto& [name, tensor] : state.detail.optimizer.state()) {
            tensors.emplace_back("detail.optimizer." + name, tensor);
        }
        if (!state.detail.targets.empty())
            tensors.emplace_back("detail.targets", at::cat(state.detail.targets));
    }
    tensors.emplace_back("curve.direction_length", at::tensor(state.direction_length));
    tensors.emplace_back("curve.source_loss", at::tensor(state.source_loss));
    append_adjustment(tensors, state.adjustment);
}

/// Returns the first process's checkpoint on all processes.
std::optional<Checkpoint> read_checkpoint(const EditRequest& request) {
    const ProcessGroup& processes = request.processes;
    std::optional<Checkpoint> checkpoint;
    if (processes.first()) checkpoint = load_checkpoint(checkpoint_path(request));
    if (!processes.several()) return checkpoint;
    nlohmann::json header;
    if (checkpoint) header = {checkpoint->identity, checkpoint->iteration};
    header = nlohmann::json::parse(processes.broadcast(header.dump()));
    if (header.is_null()) return std::nullopt;
    Checkpoint all{header[0], header[1].get<std::int64_t>(), {}};
    all.tensors = processes.broadcast(checkpoint ? checkpoint->tensors : NamedTensors());
    return all;
}

}  // namespace

void save_state(const EditRequest& request, const EditState& state) {
    if (!request.processes.first()) return;
    Checkpoint checkpoint;
    checkpoint.identity = identity_of(request, state);
    checkpoint.identity["begun"] = state.begun;
    checkpoint.iteration = state.iteration;
    if (state.painter) {
        for (const auto& [name, tensor] : state.painter->state())
            checkpoint.tensors.emplace_back("painter." + name, tensor);
    } else {
        append_field(checkpoint.tensors, state);
    }
    checkpoint.tensors.emplace_back("unet_rows", at::full({1}, state.unet_rows(), at::kLong));
    save_checkpoint(checkpoint_path(request), checkpoint);
}

void require_one_request(const EditRequest& request, const EditState& state) {
    const ProcessGroup& processes = request.processes;
    if (!processes.several()) return;
    const nlohmann::json own = identity_of(request, state);
    const auto first = nlohmann::json::parse(processes.broadcast(own.dump()));
    std::string difference;
    for (const auto& [key, value] : own.items())
        if (difference.empty() && (!first.contains(key) || first.at(key) != value))
            difference =
                fmt::format("'{}' differs from process 0: {} instead of {}", key, value.dump(),
                            first.contains(key) ? first.at(key).dump() : "none");
    if (!processes.any(!difference.empty())) return;
    throw InputError(
        fmt::format("process {} of {}", processes.rank(), processes.size()),
        difference.empty() ? "another process has different files or options" : difference,
        "give all processes the same files and options");
}

bool load_state(const EditRequest& request, EditState& state) {
    const auto checkpoint = read_checkpoint(request);
    if (!checkpoint) return false;
    require_same_identity(checkpoint_path(request), checkpoint->identity,
                          identity_of(request, state),
                          {{"model", "was made for another model file"},
                           {"prior_weights", "was made with other weights of the prior"}});

    const CheckpointReader reader(checkpoint_path(request).string(), checkpoint->tensors);
    state.iteration = checkpoint->iteration;
    state.begun = checkpoint->identity.value("begun", state.begun);
    if (reader.has("unet_rows"))
        state.earlier_unet_rows = reader.get("unet_rows").item<std::int64_t>();
    if (state.painter) {
        NamedTensors painted;
        for (const auto& [name, tensor] : reader.with_prefix("painter."))
            painted.emplace_back(name, tensor);
        state.painter->load_state(CheckpointReader(checkpoint_path(request).string(), painted));
        return true;
    }
    reader.parameters("fitted.", state.fitted->named_parameters());
    reader.parameters("field.", state.field->named_parameters());
    if (state.light) reader.parameters("light.", state.light->named_parameters());
    state.optimizer.load_state(reader.with_prefix("optimizer."));
    NamedTensors guidance;
    for (const auto& [name, tensor] : reader.with_prefix("guidance.")) {
        guidance.emplace_back(name, tensor);
    }
    state.guidance->load_state(guidance);
    if (reader.has("detail.before.table")) {
        state.detail.begin(state.field);
        reader.parameters("detail.before.", state.detail.before->named_parameters());
        state.detail.optimizer.load_state(reader.with_prefix("detail.optimizer."));
        if (reader.has("detail.targets"))
            state.detail.targets =
                reader.get("detail.targets").to(state.field->table().device()).split(1);
    }
    state.direction_length = to_floats(reader.get("curve.direction_length"));
    state.source_loss = to_floats(reader.get("curve.source_loss"));
    read_adjustment(reader, state.adjustment);
    return true;
}

}  // namespace item3d
