#include "item3d/reconstruct/surface/refine.h"

#include "item3d/core/format.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

constexpr double final_rate = 0.1;
constexpr std::int64_t smoothness_points = 4096;
constexpr float farthest_smoothness = 0.15f;  ///< of the object's diagonal
constexpr int traces = 4;                     ///< of shadows, in all
constexpr std::uint64_t refine_stream = 0x726566696e65;

double falling(double rate, int iteration, int iterations) {
    const double progress = static_cast<double>(iteration) / iterations;
    return rate * (final_rate + (1 - final_rate) * 0.5 * (1 + std::cos(pi * progress)));
}

/// radiance: undefined: from everywhere.
Occlusion trace_occlusion(const MovableMesh& mesh, const torch::Tensor& radiance) {
    const torch::NoGradGuard no_gradient;
    OcclusionOptions options;
    options.rays = 128;
    if (radiance.defined()) options.light = to_image(radiance);
    return Occlusion(mesh.geometry(), nullptr, options);
}

}  // namespace

Refinement::Refinement(Appearance& appearance, MovableMesh& mesh, const Model& model,
                       std::vector<TargetView> views, const RefineOptions& options)
    : Stage(appearance),
      mesh_(mesh),
      views_(std::move(views)),
      options_(options),
      pixel_(pixel_size(model.bounds(), views_.front())),
      farthest_(farthest_smoothness * glm::length(model.bounds()[1] - model.bounds()[0])),
      order_(views_.size(), options.seed) {
    learning_.random = Random(options.seed, refine_stream);
    Adam& adam = learning_.optimizer;
    adam.add_group({appearance.field->table()}, {.learning_rate = options.field_learning_rate});
    adam.add_group(appearance.field->network_parameters(),
                   {.learning_rate = 0.5 * options.field_learning_rate});
    adam.add_group(appearance.light.parameters(),
                   {.learning_rate = options.light_learning_rate, .beta2 = 0.999});
    if (mesh.moves()) {
        adam.add_group(
            {mesh.offsets()},
            {.learning_rate = options.vertex_learning_rate * mesh.mean_edge(), .beta2 = 0.999});
    }
    for (std::size_t group = 0; group < adam.group_count(); ++group)
        rates_.push_back(adam.options(group).learning_rate);
}

void Refinement::trace() {
    traced_ = {};
    const torch::NoGradGuard no_gradient;
    if (mesh_.moves()) traced_.offsets = mesh_.offsets().detach().clone();
    if (iteration() > 0) traced_.radiance = appearance_.light.radiance();
    occlusion_ = trace_occlusion(mesh_, traced_.radiance);
}

RenderedView Refinement::render(const TargetView& view, bool light_alone) {
    Geometry geometry = mesh_.geometry();
    // One material would dent what is printed on it, so the shape stands still meanwhile.
    if (light_alone) {
        geometry.positions = geometry.positions.detach();
        geometry.normals = geometry.normals.detach();
    }
    return render_view(geometry, appearance_.field, learning_.light, view,
                       {.occlusion = occlusion_ ? &*occlusion_ : nullptr,
                        .normal_map = options_.normal_map && !light_alone,
                        .one_material = light_alone});
}

torch::Tensor Refinement::regularization(const RenderedView& rendered, const TargetView& view,
                                         const torch::Tensor& mask) {
    const RegularizerWeights& weights = options_.weights;
    torch::Tensor loss = torch::zeros({});
    if (rendered.surface.count() > 0) {
        loss = loss +
               weights.smoothness * smoothness_loss(appearance_.field, rendered, pixel_, farthest_,
                                                    smoothness_points, learning_.random) +
               weights.brightness * brightness_loss(rendered);
        if (weights.demodulation > 0)
            loss = loss + weights.demodulation *
                              demodulated_light_loss(rendered, learning_.light, view.image);
        if (options_.normal_map)
            loss = loss + weights.flat_normals * (1 - rendered.material.normal.select(1, 2)).mean();
    }
    if (mesh_.moves()) loss = loss + weights.mask * mask + weights.crumpling * mesh_.crumpling();
    return loss;
}

void Refinement::step() {
    const int i = iteration();
    const int trace_every = std::max(1, (options_.iterations + traces - 1) / traces);
    if (options_.shadows && i % trace_every == 0) trace();
    const bool light_learns = learning_.update_light(appearance_, i, options_.light_every);
    const TargetView& view = views_[order_.at(i)];
    const RenderedView rendered = render(view, i < options_.light_alone * options_.iterations);
    const torch::Tensor background =
        torch::full({3}, static_cast<float>(learning_.random.uniform()));
    const torch::Tensor picture = picture_loss(rendered.image, view.image, background);
    const torch::Tensor mask = mask_loss(rendered.image, view.image);
    torch::Tensor loss = picture + regularization(rendered, view, mask);
    if (light_learns) loss = loss + options_.weights.whiteness * appearance_.light.whiteness_loss();
    loss.backward();
    Adam& adam = learning_.optimizer;
    for (std::size_t group = 0; group < rates_.size(); ++group)
        adam.options(group).learning_rate = falling(rates_[group], i, options_.iterations);
    adam.step();
    adam.zero_grad();
    learning_.note_losses(picture, mask);
    ++learning_.iteration;
}

std::string Refinement::detail() const {
    return fmt::format("difference {:.4f}", learning_.curves.picture.back());
}

RenderedView Refinement::draw(const TargetView& view) {
    const torch::NoGradGuard no_gradient;
    return render(view, false);
}

NamedTensors Refinement::state() const {
    NamedTensors tensors = Stage::state();
    if (mesh_.moves()) tensors.emplace_back("offsets", mesh_.offsets().detach());
    if (traced_.offsets.defined()) tensors.emplace_back("traced.offsets", traced_.offsets);
    if (traced_.radiance.defined()) tensors.emplace_back("traced.radiance", traced_.radiance);
    return tensors;
}

void Refinement::load_state(const CheckpointReader& reader) {
    Stage::load_state(reader);
    learning_.random =
        Random(options_.seed, refine_stream,
               static_cast<std::uint64_t>(reader.get("random").item<std::int64_t>()));
    if (reader.has("traced.radiance")) traced_.radiance = reader.get("traced.radiance");
    if (options_.shadows && iteration() > 0 && !is_done()) {
        if (mesh_.moves()) {
            traced_.offsets = reader.get("traced.offsets");
            reader.copy("traced.offsets", mesh_.offsets());
        }
        occlusion_ = trace_occlusion(mesh_, traced_.radiance);
    }
    if (mesh_.moves()) reader.copy("offsets", mesh_.offsets());
}

}  // namespace item3d
