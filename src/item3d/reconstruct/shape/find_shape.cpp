#include "item3d/reconstruct/shape/find_shape.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/reconstruct/surface/movable_mesh.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

/// Maximum offset of a lattice vertex, in cells. It is below 0.5, so that neighbouring vertices
/// never pass each other.
constexpr float largest_offset = 0.45f;
/// Limit of the values' magnitude, in cells.
constexpr float largest_value = 3.0f;
/// Maximum number of points in the smoothness loss of one step, for any lattice.
constexpr std::int64_t smoothness_points_of_shape = 2048;

[[noreturn]] void refuse_vanished_shape() {
    throw InputError("reconstruct", "the shape vanished during the optimisation",
                     "check that masks and poses belong together, and that the object is not tiny");
}

/// Returns the number of images that show each vertex, [V].
at::Tensor views_that_show(const at::Tensor& positions, const std::vector<TargetView>& views) {
    at::Tensor count = at::zeros({positions.size(0)});
    for (const TargetView& view : views) {
        const Mat4 clip = view.camera.world_to_clip(view.width(), view.height());
        const auto row = [&](int r) {
            return positions.matmul(at::tensor({clip[0][r], clip[1][r], clip[2][r]})) + clip[3][r];
        };
        const at::Tensor w = row(3);
        count += (row(0).abs() < w).logical_and(row(1).abs() < w).to(at::kFloat);
    }
    return count;
}

double blend(double first, double last, int iteration, int iterations) {
    return first + (last - first) * static_cast<double>(iteration) / std::max(1, iterations);
}

}  // namespace

ShapeField::ShapeField(const Lattice& lattice, const std::string& name, const at::Tensor& start)
    : cell(lattice.cell), extraction(make_extraction(name, lattice)), places(lattice.vertices()) {
    values = start.clamp(-largest_value, largest_value).clone().set_requires_grad(true);
    offsets = at::zeros_like(places).set_requires_grad(true);
}

at::Tensor ShapeField::vertices() const {
    return places + cell * largest_offset * at::tanh(offsets);
}

TriangleMesh ShapeField::mesh() {
    const at::NoGradGuard no_gradient;
    return extraction->mesh(values, vertices());
}

Geometry untextured_geometry(const at::Tensor& positions, const at::Tensor& triangles) {
    const std::int64_t vertices = positions.size(0), count = triangles.size(0);
    Geometry geometry;
    geometry.positions = positions;
    geometry.normals = vertex_normals(positions, triangles);
    geometry.tangents = at::zeros({vertices, 4});
    geometry.uvs = at::zeros({vertices, 2});
    geometry.colors = at::ones({vertices, 4});
    geometry.triangles = triangles.to(at::kInt);
    geometry.triangle_material = at::zeros({count}, at::kInt);
    geometry.triangle_primitive = at::zeros({count}, at::kInt);
    geometry.neighbours = mesh_neighbours(triangles, vertices);
    return geometry;
}

double mask_overlap(const TriangleMesh& mesh, const std::vector<TargetView>& views) {
    const at::NoGradGuard no_gradient;
    const Geometry geometry = untextured_geometry(mesh.positions, mesh.triangles);
    double both = 0, either = 0;
    for (const TargetView& view : views) {
        const Raster raster = rasterize(geometry, {view.camera}, view.width(), view.height());
        const at::Tensor drawn = raster.triangle >= 0;
        const at::Tensor truth = view.image.select(3, 3) >= 0.5f;
        both += drawn.logical_and(truth).sum().item<double>();
        either += drawn.logical_or(truth).sum().item<double>();
    }
    return either > 0 ? both / either : 0.0;
}

ShapeSearch::ShapeSearch(const Dataset& dataset, const VisualHull& hull, std::array<Vec3, 2> bounds,
                         Appearance& appearance, ViewCorrections& corrections,
                         const ShapeOptions& options)
    : Stage(appearance, corrections),
      options_(options),
      order_(dataset.train.size(), options.seed) {
    ITEM3D_CHECK(!options.cells.empty(), "at least one lattice");
    lattice_ = make_lattice(bounds, options.cells.front());
    const Vec3 size(lattice_.cells[0], lattice_.cells[1], lattice_.cells[2]);
    views_ = make_targets(dataset.train, {lattice_.origin, lattice_.origin + lattice_.cell * size});
    begin_level(0, hull.distance(lattice_.vertices()) / lattice_.cell);
}

int ShapeSearch::end_of_level(int level) const {
    const auto levels = static_cast<int>(options_.cells.size());
    const int coarse = options_.iterations / (levels + 1);
    return level + 1 < levels ? (level + 1) * coarse : options_.iterations;
}

void ShapeSearch::begin_level(int level, const at::Tensor& start) {
    level_ = level;
    field_ = std::make_unique<ShapeField>(lattice_, options_.extraction, start);
    const int first = level > 0 ? end_of_level(level - 1) : 0;
    learning_.random =
        Random(options_.seed, RandomStream::shape, static_cast<std::uint64_t>(first) << 32);
    learning_.optimizer = {};
    Adam& adam = learning_.optimizer;
    adam.add_group("table", {appearance_.field->table()}, {.learning_rate = 0.01});
    adam.add_group("network", appearance_.field->network_parameters(), {.learning_rate = 0.005});
    adam.add_group("light", appearance_.light.parameters(),
                   {.learning_rate = 0.05, .beta2 = 0.999});
    adam.add_group("light scale", {appearance_.light.log_scale()},
                   {.learning_rate = 0.02, .beta2 = 0.999});
    adam.add_group("values", {field_->values},
                   {.learning_rate = options_.value_learning_rate, .beta2 = 0.999});
    adam.add_group("offsets", {field_->offsets},
                   {.learning_rate = options_.offset_learning_rate, .beta2 = 0.999});
    adam.add_group("weights", field_->extraction->weights(),
                   {.learning_rate = options_.weight_learning_rate, .beta2 = 0.999});
}

void ShapeSearch::start_next_level() {
    const at::NoGradGuard no_gradient;
    const at::Tensor start = 2 * refined_values(field_->values, lattice_);
    lattice_ = lattice_.refined();
    begin_level(level_ + 1, start);
}

at::Tensor ShapeSearch::loss_besides_image(const RenderedView& rendered,
                                           const ExtractedSurface& surface, bool light_alone) {
    const double sign_change_weight =
        light_alone ? 0.0
                    : blend(options_.sign_change_weight_first, options_.sign_change_weight_last,
                            iteration(), options_.iterations);
    const float nearest = 0.25f * lattice_.cell;
    at::Tensor loss = sign_change_weight * sign_change_loss(surface.edges, field_->values) +
                      options_.smoothness_weight *
                          smoothness_loss(appearance_.field, rendered, nearest, 40 * nearest,
                                          smoothness_points_of_shape, learning_.random);
    if (surface.regularizer.defined() && !light_alone)
        loss = loss + options_.regularizer_weight * surface.regularizer;
    return loss;
}

void ShapeSearch::step() {
    while (iteration() == end_of_level(level_))
        start_next_level();
    const int first = level_ > 0 ? end_of_level(level_ - 1) : 0;
    const int i = iteration() - first, count = end_of_level(level_) - first;
    const bool light_learns = learning_.update_light(appearance_, i, options_.light_every);
    const ExtractedSurface surface =
        field_->extraction->extract(field_->values, field_->vertices());
    if (surface.triangles.size(0) == 0) refuse_vanished_shape();
    // The gradient of a model with a single material would carve printed patterns into the hull. So
    // the shape is fixed as long as the light alone explains the images.
    const bool light_alone = iteration() < options_.light_alone * options_.iterations;
    const Geometry geometry = untextured_geometry(
        light_alone ? surface.positions.detach() : surface.positions, surface.triangles);
    const std::size_t index = order_.at(iteration());
    const TargetView& view = views_[index];
    ViewRenderOptions how{.one_material = light_alone,
                          .gain = corrections_.gain(index),
                          .base_color_factor = learning_.base_color_factor};
    how.motion = corrections_.motion(index).detached();
    const RenderedView rendered =
        render_view(geometry, appearance_.field, learning_.light, view, how);
    const at::Tensor background = at::full({3}, static_cast<float>(learning_.random.uniform()));
    const at::Tensor image = image_loss(rendered.image, view.image, background);
    const at::Tensor mask = mask_loss(rendered.image, view.image);
    at::Tensor loss = corrections_.weight(index) * (image + options_.mask_weight * mask) +
                      loss_besides_image(rendered, surface, light_alone);
    if (light_learns)
        loss = loss + options_.whiteness_weight * appearance_.light.whiteness_loss() +
               light_scale_loss(appearance_.light, learning_.light, rendered, options_.light_scale);
    loss.backward();
    const double rate = blend(1.0, 0.2, i, count);
    Adam& adam = learning_.optimizer;
    adam.options("values").learning_rate = rate * options_.value_learning_rate;
    adam.options("offsets").learning_rate = rate * options_.offset_learning_rate;
    adam.options("weights").learning_rate = rate * options_.weight_learning_rate;
    adam.step();
    adam.zero_grad();
    {
        const at::NoGradGuard no_gradient;
        field_->values.clamp_(-largest_value, largest_value);
    }
    if (!light_alone) {
        corrections_.update_gain(index, rendered.without_gain, view.image);
        corrections_.update_motion(index, as_drawn(view, rendered), view.image);
    }
    learning_.note_losses(image, mask);
    triangles_.push_back(static_cast<double>(surface.triangles.size(0)));
    ++learning_.iteration;
}

std::string ShapeSearch::detail() const {
    return fmt::format("difference {:.4f}, {:.0f} triangles", learning_.curves.image.back(),
                       triangles_.back());
}

RenderedView ShapeSearch::draw(const TargetView& view) {
    const at::NoGradGuard no_gradient;
    const TriangleMesh mesh = field_->mesh();
    if (mesh.triangles.size(0) == 0) refuse_vanished_shape();
    return render_view(untextured_geometry(mesh.positions, mesh.triangles), appearance_.field,
                       learning_.light, view);
}

NamedTensors ShapeSearch::state() const {
    NamedTensors tensors = Stage::state();
    tensors.emplace_back("level", at::tensor({std::int64_t{level_}}));
    tensors.emplace_back("values", field_->values.detach());
    tensors.emplace_back("offsets", field_->offsets.detach());
    const auto weights = field_->extraction->weights();
    for (std::size_t i = 0; i < weights.size(); ++i)
        tensors.emplace_back("weights." + std::to_string(i), weights[i].detach());
    tensors.emplace_back("curve.triangles", curve_tensor(triangles_));
    return tensors;
}

void ShapeSearch::load_state(const CheckpointReader& reader) {
    const auto level = reader.get("level").item<std::int64_t>();
    while (level_ < level)
        start_next_level();
    Stage::load_state(reader);
    learning_.random =
        Random(options_.seed, RandomStream::shape,
               static_cast<std::uint64_t>(reader.get("random").item<std::int64_t>()));
    reader.copy("values", field_->values);
    reader.copy("offsets", field_->offsets);
    const auto weights = field_->extraction->weights();
    for (std::size_t i = 0; i < weights.size(); ++i)
        reader.copy("weights." + std::to_string(i), weights[i]);
    triangles_ = curve_values(reader.get("curve.triangles"));
}

FoundShape ShapeSearch::shape() {
    const TriangleMesh mesh = field_->mesh();
    if (mesh.triangles.size(0) == 0) refuse_vanished_shape();
    const TriangleMesh seen = without_ghosts(mesh, views_that_show(mesh.positions, views_),
                                             0.5 * static_cast<double>(views_.size()));
    return {simplified(without_specks(seen), options_.triangles), learning_.curves, triangles_, 0};
}

}  // namespace item3d
