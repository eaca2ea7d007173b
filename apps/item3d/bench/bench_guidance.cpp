// Command item3d bench guidance: measures the time and memory of a guidance step with a prior.
#include "apps/item3d/bench/bench_guidance.h"

#include "apps/item3d/command.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/stage_times.h"
#include "item3d/guidance/guidance.h"
#include "item3d/guidance/noised_latents.h"
#include "item3d/hub/find_prior.h"
#include "item3d/networks/diffusion/running_pipeline.h"
#include "item3d/tensors/precision.h"

#include <algorithm>
#include <memory>

namespace item3d {
namespace {

struct BenchGuidanceCommand : CommonOptions {
    std::string prior;
    std::string precision = "auto";
    std::string method = "rdl";
    std::string adjust = "off";
    int size = 0;  ///< 0: the prior's own size
    int batch = 1;
    int repeats = 5;
};

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

void run(const BenchGuidanceCommand& options, at::Device device) {
    const auto folder = find_prior(options.prior);
    const at::ScalarType precision = choose_precision(options.precision, device);
    const double begin = seconds_now();
    GuidanceOptions guidance_options;
    guidance_options.method = options.method;
    guidance_options.adjust = parse_adjustment(options.adjust);
    const std::string from = "a red mug", to = "a golden mug";
    const auto prior =
        std::make_shared<const RunningPipeline>(RunningPipeline::load(  // loaded as in an edit
            folder, device, precision, {}, {{from, to, default_negative_prompt()}, false}));
    const double loaded = seconds_now();
    const auto guidance = make_guidance(prior, from, to, guidance_options);
    const int size = options.size > 0 ? options.size : prior->native_size();
    const at::Tensor images =
        at::rand({options.batch, 3, size, size}, device).set_requires_grad(true);
    const at::Tensor nowhere = at::zeros({options.batch, size, size, 3}, device);
    const SeenShape shape{at::ones({options.batch, size, size}, device), nowhere, nowhere};

    GuidanceInput input{images, shape};
    if (guidance->needs_reference()) input.reference = at::rand_like(images);

    std::vector<double> step, encode, unet;
    double first = 0;
    Progress progress("bench", options.repeats);
    for (int i = -1; i < options.repeats; ++i) {
        if (interrupted()) throw Interrupted("nothing was written");
        const double start = seconds_now();
        const GuidanceOutput output = guidance->step(input, i + 1);
        output.latents.backward(output.latents_gradient);
        // The check also waits for the device.
        ITEM3D_CHECK(images.grad().isfinite().all().item<bool>(), "the gradient is not finite");
        const double taken = seconds_now() - start;
        images.mutable_grad() = at::Tensor();
        if (i < 0) {
            first = seconds_now() - begin;
            continue;
        }
        step.push_back(taken);
        encode.push_back(output.seconds_encode);
        unet.push_back(output.seconds_unet);
        progress.update(i + 1);
    }
    progress.finish();
    const double seconds = median(step), peak = static_cast<double>(peak_memory_bytes());
    const double backward = std::max(0.0, seconds - median(encode) - median(unet));
    if (options.json) {
        print_json({{"prior", folder.string()},
                    {"method", options.method},
                    {"adjust", options.adjust},
                    {"precision", precision_name(precision)},
                    {"size", size},
                    {"batch", options.batch},
                    {"load_seconds", loaded - begin},
                    {"first_step_after_seconds", first},
                    {"seconds_per_step", seconds},
                    {"encode_seconds", median(encode)},
                    {"unet_seconds", median(unet)},
                    {"backward_seconds", backward},
                    {"peak_memory_bytes", peak}});
        return;
    }
    fmt::print("{}, {}, {} x {} pixels, batch {}, {}\n", folder.string(), options.method, size,
               size, options.batch, precision_name(precision));
    fmt::print("  load                 {:8.2f} s\n", loaded - begin);
    fmt::print("  first step done after{:8.2f} s\n", first);
    fmt::print("  a step               {:8.3f} s\n", seconds);
    fmt::print("    encode             {:8.3f} s\n", median(encode));
    fmt::print("    U-Net              {:8.3f} s\n", median(unet));
    fmt::print("    back to the image  {:8.3f} s\n", backward);
    fmt::print("  peak memory          {:8.2f} GB\n", peak / 1e9);
}

}  // namespace

void add_bench_guidance(CLI::App& app) {
    auto options = std::make_shared<BenchGuidanceCommand>();
    CLI::App* command = add_command(
        app, "guidance", "Seconds and memory of one step of guidance with a prior", *options);
    command->add_option("--prior", options->prior,
                        "A folder in the diffusers layout, or a name. Default: the embedded prior");
    command->add_option("--precision", options->precision, "Precision of the networks")
        ->check(CLI::IsMember(precision_names()))
        ->capture_default_str();
    command->add_option("--guidance", options->method, "Guidance method")
        ->check(CLI::IsMember(guidance_methods()))
        ->capture_default_str();
    command->add_option("--adjust", options->adjust, "Adjustment of the direction")
        ->check(CLI::IsMember(adjustment_names()))
        ->capture_default_str();
    command
        ->add_option("--size", options->size,
                     "Edge length of the image, in pixels. Default: the prior's own")
        ->check(CLI::Range(64, 4096));
    command->add_option("--batch", options->batch, "Images per step")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command
        ->add_option("--repeats", options->repeats,
                     "Steps after the first; their median is reported")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    command->callback([options] { run(*options, start_command(*options)); });
}

}  // namespace item3d
