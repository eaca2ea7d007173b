// Command item3d guidance: computes gradients of guidance for the images of another program, over
// pipes.
#include "item3d/guidance/guidance.h"

#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/edit/setting_options.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/version.h"
#include "item3d/edit/plan.h"
#include "item3d/guidance/guidance_stream.h"
#include "item3d/hub/find_prior.h"
#include "item3d/networks/diffusion/running_pipeline.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/tensors/precision.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <string>

namespace item3d {
namespace {

struct GuidanceCommand : CommonOptions {
    std::string prior;
    std::string precision = "auto";
    nlohmann::json overrides = nlohmann::json::object();
};

std::size_t read_stdin(char* to, std::size_t size) {
    for (;;) {
        if (interrupted()) throw Interrupted("the guidance has ended");
        const ssize_t count = ::read(STDIN_FILENO, to, size);
        if (count >= 0) return static_cast<std::size_t>(count);
        if (errno != EINTR) throw ResourceError("stdin: cannot be read");
    }
}

void write_stdout(const char* from, std::size_t size) {
    if (std::fwrite(from, 1, size, stdout) != size)
        throw ResourceError("stdout: cannot be written");
}

void flush_stdout() {
    if (std::fflush(stdout) != 0) throw ResourceError("stdout: cannot be written");
}

/// Throws InputError for a request that this prior and method cannot answer.
void check_request(const GuidanceInput& input, const DiffusionModel& prior,
                   const Guidance& guidance) {
    const int cell = prior.downscale();
    if (input.images.size(2) % cell != 0 || input.images.size(3) % cell != 0)
        throw InputError("stdin",
                         fmt::format("images are {} x {} pixels, and this prior needs multiples "
                                     "of {}",
                                     input.images.size(3), input.images.size(2), cell),
                         fmt::format("it was trained on {0} x {0}", prior.native_size()));
    if (prior.condition_channels() == surface_condition_channels && input.shape.depth.defined() &&
        !input.shape.position.defined())
        throw InputError("stdin", "this prior needs position and normal beside the depth",
                         "send all three or none");
    if (guidance.needs_reference() && !input.reference.defined())
        throw InputError("stdin", "this guidance needs reference images",
                         "send the unedited images of the same cameras");
}

GuidanceInput on_device(const GuidanceInput& input, at::Device device) {
    const auto moved = [&](const at::Tensor& tensor) {
        return tensor.defined() ? tensor.to(device) : tensor;
    };
    GuidanceInput result{
        moved(input.images).requires_grad_(),
        {moved(input.shape.depth), moved(input.shape.position), moved(input.shape.normal)}};
    result.reference = moved(input.reference);
    return result;
}

/// Computes the gradient with respect to the images. An overflow in a prediction becomes 0, as in
/// an edit.
void answer(const GuidanceRequest& request, const DiffusionModel& prior, Guidance& guidance) {
    check_request(request.input, prior, guidance);
    const std::int64_t rows_before = prior.predicted_rows();
    const GuidanceInput input = on_device(request.input, prior.device());
    const GuidanceOutput output = guidance.step(input, request.iteration);
    output.latents.backward(at::nan_to_num(output.latents_gradient, 0.0, 0.0, 0.0));
    nlohmann::json line{
        {"iteration", request.iteration},    {"direction_length", output.direction_length},
        {"source_loss", output.source_loss}, {"timestep", output.timestep},
        {"noise_seed", output.noise_seed},   {"unet_rows", prior.predicted_rows() - rows_before}};
    if (const auto direction = guidance.text_direction())
        line["direction"] = {{"angle", direction->angle}, {"length", direction->length}};
    write_guidance_reply(write_stdout, line, input.images.grad());
    flush_stdout();
}

void run_guidance(const GuidanceCommand& command, at::Device device) {
    const std::filesystem::path folder = find_prior(command.prior);
    const EditPlan plan = resolve_plan(folder, command.overrides);
    check_settings(plan);
    if (plan.asks_captioner)
        throw UsageError("--adjust caption: looks at renders of an edit; use learned or off");
    const PriorVocabulary vocabulary = PriorVocabulary::load(folder);
    for (const std::string& sentence : {plan.from, plan.to})
        if (const std::string warning = vocabulary.warning(sentence, false); !warning.empty())
            warn(warning);
    const std::string from = vocabulary.reading(plan.from), to = vocabulary.reading(plan.to);
    const auto prior = std::make_shared<const RunningPipeline>(RunningPipeline::load(
        folder, device, choose_precision(command.precision, device), plan,
        {{from, to, plan.negative_prompt, default_negative_prompt()}, false}));
    const auto guidance = make_guidance(prior, from, to, plan.guidance_options());
    const nlohmann::json ready{{"version", version()},
                               {"size", prior->native_size()},
                               {"downscale", prior->downscale()},
                               {"takes_shape", takes_shape(*prior)},
                               {"needs_reference", guidance->needs_reference()}};
    const std::string line = ready.dump() + "\n";
    write_stdout(line.data(), line.size());
    flush_stdout();
    while (const auto request = read_guidance_request(read_stdin))
        answer(*request, *prior, *guidance);
}

}  // namespace

void add_guidance_command(CLI::App& app) {
    auto options = std::make_shared<GuidanceCommand>();
    CLI::App* command = add_command(app, "guidance", *options);
    command
        ->add_option("--prior", options->prior,
                     "Diffusion model: a folder in the diffusers layout, or a name (`item3d prior "
                     "list`). Without it: the embedded one")
        ->type_name("PRIOR");
    command->add_option("--precision", options->precision, "Number format of the networks")
        ->check(CLI::IsMember(precision_names()))
        ->capture_default_str();
    for (const char* name : {"from", "to"})
        add_setting(*command, options->overrides, name)->required();
    for (const char* name : {"guidance", "adjust", "cfg", "negative_prompt", "anchor", "iterations",
                             "timesteps", "seed"})
        add_setting(*command, options->overrides, name);
    add_extras_options(*command, options->overrides);
    command->callback([options] { run_guidance(*options, start_command(*options)); });
}

}  // namespace item3d
