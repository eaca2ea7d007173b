#include "item3d/reconstruct/surface/refine.h"

#include "item3d/core/format.h"
#include "item3d/render/image_tensor.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

constexpr double final_rate = 0.1;
constexpr std::int64_t smoothness_points = 4096;
constexpr float farthest_smoothness = 0.15f;  ///< relative to the object's diagonal

double falling(double rate, int iteration, int iterations) {
    const double progress = static_cast<double>(iteration) / iterations;
    return rate * (final_rate + (1 - final_rate) * 0.5 * (1 + std::cos(pi * progress)));
}

/// Traces occlusion. An undefined `radiance` stands for uniform light.
Occlusion trace_occlusion(const MovableMesh& mesh, const at::Tensor& radiance,
                          std::int64_t max_points) {
    const at::NoGradGuard no_gradient;
    OcclusionOptions options;
    options.max_points = max_points;
    options.rays = 128;
    if (radiance.defined()) options.light = to_image(radiance);
    return Occlusion(mesh.geometry(), nullptr, options);
}

}  // namespace

Refinement::Refinement(Appearance& appearance, ViewCorrections& corrections, MovableMesh& mesh,
                       const Model& model, std::vector<TargetView> views,
                       const RefineOptions& options)
    : Stage(appearance, corrections),
      mesh_(mesh),
      views_(std::move(views)),
      options_(options),
      pixel_(pixel_size(model.bounds(), views_.front())),
      farthest_(farthest_smoothness * glm::length(model.bounds()[1] - model.bounds()[0])),
      order_(views_.size(), options.seed) {
    learning_.random = Random(options.seed, RandomStream::refinement);
    const auto add = [&](const char* group, const std::vector<at::Tensor>& parameters,
                         const AdamOptions& adam_options) {
        learning_.optimizer.add_group(group, parameters, adam_options);
        rates_[group] = adam_options.learning_rate;
    };
    add("table", {appearance.field->table()}, {.learning_rate = options.field_learning_rate});
    add("network", appearance.field->network_parameters(),
        {.learning_rate = 0.5 * options.field_learning_rate});
    add("light", appearance.light.parameters(),
        {.learning_rate = options.light_learning_rate, .beta2 = 0.999});
    add("light scale", {appearance.light.log_scale()},
        {.learning_rate = options.light_scale_learning_rate, .beta2 = 0.999});
    if (mesh.moves())
        add("offsets", {mesh.offsets()},
            {.learning_rate = options.vertex_learning_rate * mesh.mean_edge(), .beta2 = 0.999});
}

void Refinement::trace() {
    traced_ = {};
    const at::NoGradGuard no_gradient;
    balance_base_color(appearance_.field, appearance_.light);
    if (mesh_.moves()) traced_.offsets = mesh_.offsets().detach().clone();
    if (iteration() > 0) traced_.radiance = appearance_.light.radiance();
    occlusion_ = trace_occlusion(mesh_, traced_.radiance, options_.shadow_points);
    if (iteration() == 0) return;
    // The light is prefiltered here, because a resumed run has no prefiltered light yet.
    const EnvironmentLight light = appearance_.light.prefiltered();
    indirect_.emplace(mesh_.geometry(), nullptr,
                      IndirectLightOptions{.max_points = options_.shadow_points / 2});
    indirect_->update([&](const Raster& raster, const Surface& surface, const at::Tensor& bounce) {
        MaterialSample material = appearance_.field->forward(surface.position);
        material.orm = at::cat(
            {occlusion_->at(raster, surface).unsqueeze(1), material.orm.narrow(1, 1, 2)}, 1);
        return outgoing_radiance(surface, std::move(material), light, bounce);
    });
    traced_.indirect = indirect_->stored();
}

RenderedView Refinement::render(const TargetView& view, ViewRenderOptions how) {
    Geometry geometry = mesh_.geometry();
    // The gradient of a model with a single material would dent printed patterns into the shape. So
    // the shape is fixed during these iterations.
    if (how.one_material) {
        geometry.positions = geometry.positions.detach();
        geometry.normals = geometry.normals.detach();
    }
    how.occlusion = occlusion_ ? &*occlusion_ : nullptr;
    how.indirect = indirect_ ? &*indirect_ : nullptr;
    how.base_color_factor = learning_.base_color_factor;
    how.seed = mix_bits(options_.seed ^ static_cast<std::uint64_t>(iteration()));
    how.normal_map = options_.normal_map && !how.one_material;
    return render_view(geometry, appearance_.field, learning_.light, view, how);
}

at::Tensor Refinement::regularization(const RenderedView& rendered, const at::Tensor& mask) {
    const RegularizerWeights& weights = options_.weights;
    at::Tensor loss = at::zeros({});
    if (rendered.surface.count() > 0) {
        loss = loss + weights.smoothness * smoothness_loss(appearance_.field, rendered, pixel_,
                                                           farthest_, smoothness_points,
                                                           learning_.random);
        if (iteration() > options_.decision_begin * options_.iterations) {
            const at::Tensor metallic = rendered.material.orm.select(1, 2);
            loss = loss + weights.decision * (metallic * (1 - metallic)).mean() +
                   weights.dark_metal * dark_metal_loss(rendered) +
                   weights.rough_metal * rough_metal_loss(rendered);
        }
        if (options_.normal_map)
            loss = loss + weights.flat_normals * (1 - rendered.material.normal.select(1, 2)).mean();
    }
    if (mesh_.moves()) loss = loss + weights.mask * mask + weights.crumpling * mesh_.crumpling();
    return loss;
}

void Refinement::step() {
    const int i = iteration();
    const int trace_every =
        std::max(1, (options_.iterations + options_.traces - 1) / options_.traces);
    if (options_.shadows && i % trace_every == 0) trace();
    const bool light_learns = learning_.update_light(appearance_, i, options_.light_every);
    const std::size_t index = order_.at(i);
    const TargetView& view = views_[index];
    const bool light_alone = i < options_.light_alone * options_.iterations;
    const RenderedView rendered = render(view, {.one_material = light_alone,
                                                .motion = corrections_.motion(index).detached(),
                                                .gain = corrections_.gain(index)});
    const at::Tensor background = at::full({3}, static_cast<float>(learning_.random.uniform()));
    const at::Tensor image = image_loss(rendered.image, view.image, background);
    const at::Tensor mask = mask_loss(rendered.image, view.image);
    at::Tensor loss = corrections_.weight(index) * image + regularization(rendered, mask);
    if (light_learns)
        loss = loss + options_.weights.whiteness * appearance_.light.whiteness_loss() +
               light_scale_loss(appearance_.light, learning_.light, rendered,
                                options_.weights.light_scale);
    loss.backward();
    // With a single material the light would learn the object's colour and keep it later.
    if (light_alone) appearance_.light.take_color_from_gradients();
    Adam& adam = learning_.optimizer;
    for (const auto& [group, rate] : rates_)
        adam.options(group).learning_rate = falling(rate, i, options_.iterations);
    adam.step();
    adam.zero_grad();
    if (!light_alone) {
        corrections_.update_gain(index, rendered.without_gain, view.image);
        corrections_.update_motion(index, as_drawn(view, rendered), view.image);
    }
    learning_.note_losses(image, mask);
    ++learning_.iteration;
}

std::string Refinement::detail() const {
    return fmt::format("difference {:.4f}", learning_.curves.image.back());
}

RenderedView Refinement::draw(const TargetView& view) {
    const at::NoGradGuard no_gradient;
    return render(view, {});
}

NamedTensors Refinement::state() const {
    NamedTensors tensors = Stage::state();
    if (mesh_.moves()) tensors.emplace_back("offsets", mesh_.offsets().detach());
    if (traced_.offsets.defined()) tensors.emplace_back("traced.offsets", traced_.offsets);
    if (traced_.radiance.defined()) tensors.emplace_back("traced.radiance", traced_.radiance);
    if (traced_.indirect.defined()) tensors.emplace_back("traced.indirect", traced_.indirect);
    return tensors;
}

void Refinement::load_state(const CheckpointReader& reader) {
    Stage::load_state(reader);
    learning_.random =
        Random(options_.seed, RandomStream::refinement,
               static_cast<std::uint64_t>(reader.get("random").item<std::int64_t>()));
    if (reader.has("traced.radiance")) traced_.radiance = reader.get("traced.radiance");
    if (options_.shadows && iteration() > 0 && !is_done()) {
        if (mesh_.moves()) {
            traced_.offsets = reader.get("traced.offsets");
            reader.copy("traced.offsets", mesh_.offsets());
        }
        occlusion_ = trace_occlusion(mesh_, traced_.radiance, options_.shadow_points);
        if (reader.has("traced.indirect")) {
            traced_.indirect = reader.get("traced.indirect");
            indirect_.emplace(mesh_.geometry(), nullptr,
                              IndirectLightOptions{.max_points = options_.shadow_points / 2});
            indirect_->restore(traced_.indirect);
        }
    }
    if (mesh_.moves()) reader.copy("offsets", mesh_.offsets());
}

}  // namespace item3d
