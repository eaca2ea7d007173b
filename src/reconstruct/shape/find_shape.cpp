#include "item3d/reconstruct/shape/find_shape.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/field/adam.h"
#include "item3d/reconstruct/view_order.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

/// How far a lattice's vertex may leave its place, in cells: two neighbours never change sides.
constexpr float largest_offset = 0.45f;
/// Values beyond this are as far inside or outside as can be.
constexpr float largest_value = 3.0f;
/// Fine enough that the hull's own outlines show, whatever lattice the shape is looked for on.
constexpr int hull_check_cells = 64;
constexpr std::int64_t smoothness_points_of_shape = 2048;

/// The signed field on one lattice: what is optimised.
struct ShapeField {
    explicit ShapeField(const Lattice& lattice, const torch::Tensor& start)
        : marching(lattice), places(lattice.vertices()) {
        values = start.clamp(-largest_value, largest_value).clone().set_requires_grad(true);
        offsets = torch::zeros_like(places).set_requires_grad(true);
    }
    torch::Tensor vertices() const {
        return places + marching.lattice().cell * largest_offset * torch::tanh(offsets);
    }

    MarchingTetrahedra marching;
    torch::Tensor places;   ///< [V, 3]
    torch::Tensor values;   ///< [V] in cells
    torch::Tensor offsets;  ///< [V, 3], before the hyperbolic tangent
};

double blend(double first, double last, int iteration, int iterations) {
    return first + (last - first) * static_cast<double>(iteration) / std::max(1, iterations);
}

void optimize_on_lattice(ShapeField& field, Appearance& appearance,
                         const std::vector<TargetView>& views, const ShapeOptions& options,
                         int first, int count, Shape& shape, Progress& progress) {
    Adam adam;
    adam.add_group({appearance.field->table()}, {.learning_rate = 0.01});
    adam.add_group(appearance.field->network_parameters(), {.learning_rate = 0.005});
    adam.add_group(appearance.light.parameters(), {.learning_rate = 0.05, .beta2 = 0.999});
    const std::size_t values = adam.add_group(
        {field.values}, {.learning_rate = options.value_learning_rate, .beta2 = 0.999});
    const std::size_t offsets = adam.add_group(
        {field.offsets}, {.learning_rate = options.offset_learning_rate, .beta2 = 0.999});
    ViewOrder order(views.size(), options.seed);
    Random random(options.seed, 0x7368617065, static_cast<std::uint64_t>(first) << 32);
    EnvironmentLight light;
    for (int i = 0; i < count; ++i) {
        const bool light_learns = i % options.light_every == 0;
        if (light_learns) {
            light = appearance.light.prefiltered();
        } else if (i % options.light_every == 1) {
            const torch::NoGradGuard no_gradient;
            light = appearance.light.prefiltered();
        }
        const MarchedTopology topology = field.marching.topology(field.values);
        if (topology.triangles.size(0) == 0) {
            throw InputError("reconstruct", "the shape vanished while it was optimised",
                             "masks and poses do not belong together, or the object is tiny");
        }
        // One material would carve what is printed on it, so the hull stands still meanwhile.
        const bool light_alone = first + i < options.light_alone * options.iterations;
        torch::Tensor positions = surface_points(topology, field.values, field.vertices());
        if (light_alone) positions = positions.detach();
        const Geometry geometry = untextured_geometry(positions, topology.triangles);
        const TargetView& view = views[order.at(first + i)];
        const RenderedView rendered =
            render_view(geometry, appearance.field, light, view, {.one_material = light_alone});
        const torch::Tensor background = torch::full({3}, static_cast<float>(random.uniform()));
        const torch::Tensor picture = picture_loss(rendered.image, view.image, background);
        const torch::Tensor mask = mask_loss(rendered.image, view.image);
        const double sign_change_weight =
            light_alone ? 0.0
                        : blend(options.sign_change_weight_first, options.sign_change_weight_last,
                                first + i, options.iterations);
        torch::Tensor loss = picture + options.mask_weight * mask +
                             sign_change_weight * sign_change_loss(topology, field.values);
        const float nearest = 0.25f * field.marching.lattice().cell;
        loss = loss + options.smoothness_weight *
                          smoothness_loss(appearance.field, rendered, nearest, 40 * nearest,
                                          smoothness_points_of_shape, random);
        loss = loss + options.brightness_weight * brightness_loss(rendered);
        if (light_learns)
            loss = loss + options.whiteness_weight * appearance.light.whiteness_loss();
        loss.backward();
        const double rate = blend(1.0, 0.2, i, count);
        adam.options(values).learning_rate = rate * options.value_learning_rate;
        adam.options(offsets).learning_rate = rate * options.offset_learning_rate;
        adam.step();
        adam.zero_grad();
        {
            const torch::NoGradGuard no_gradient;
            field.values.clamp_(-largest_value, largest_value);
        }
        shape.curves.picture.push_back(picture.item<double>());
        shape.curves.mask.push_back(mask.item<double>());
        shape.triangles.push_back(topology.triangles.size(0));
        progress.update(first + i + 1,
                        fmt::format("difference {:.4f}, {} triangles", shape.curves.picture.back(),
                                    shape.triangles.back()));
        if (interrupted()) throw Interrupted("interrupted while the shape was looked for");
    }
}

TriangleMesh marched(ShapeField& field) {
    const torch::NoGradGuard no_gradient;
    const MarchedTopology topology = field.marching.topology(field.values);
    if (topology.triangles.size(0) == 0) return {torch::zeros({0, 3}), topology.triangles};
    return {surface_points(topology, field.values, field.vertices()), topology.triangles};
}

}  // namespace

Geometry untextured_geometry(const torch::Tensor& positions, const torch::Tensor& triangles) {
    const std::int64_t vertices = positions.size(0), count = triangles.size(0);
    Geometry geometry;
    geometry.positions = positions;
    geometry.normals = vertex_normals(positions, triangles);
    geometry.tangents = torch::zeros({vertices, 4});
    geometry.uvs = torch::zeros({vertices, 2});
    geometry.colors = torch::ones({vertices, 4});
    geometry.triangles = triangles.to(torch::kInt32);
    geometry.triangle_material = torch::zeros({count}, torch::kInt32);
    geometry.triangle_primitive = torch::zeros({count}, torch::kInt32);
    geometry.neighbours = mesh_neighbours(triangles, vertices);
    return geometry;
}

double mask_overlap(const TriangleMesh& mesh, const std::vector<TargetView>& views) {
    const torch::NoGradGuard no_gradient;
    const Geometry geometry = untextured_geometry(mesh.positions, mesh.triangles);
    double both = 0, either = 0;
    for (const TargetView& view : views) {
        const Raster raster = rasterize(geometry, {view.camera}, view.width(), view.height());
        const torch::Tensor drawn = raster.triangle >= 0;
        const torch::Tensor truth = view.image.select(3, 3) >= 0.5f;
        both += drawn.logical_and(truth).sum().item<double>();
        either += drawn.logical_or(truth).sum().item<double>();
    }
    return either > 0 ? both / either : 0.0;
}

Shape find_shape(const Dataset& dataset, const VisualHull& hull, std::array<Vec3, 2> bounds,
                 Appearance& appearance, const ShapeOptions& options) {
    ITEM3D_CHECK(!options.cells.empty(), "at least one lattice");
    Shape shape;
    Lattice lattice = make_lattice(bounds, options.cells.front());
    const std::array<Vec3, 2> box{
        lattice.origin,
        lattice.origin + lattice.cell * Vec3(lattice.cells[0], lattice.cells[1], lattice.cells[2])};
    const std::vector<TargetView> views = make_targets(dataset.train, box);
    auto field =
        std::make_unique<ShapeField>(lattice, hull.distance(lattice.vertices()) / lattice.cell);
    const Lattice fine = make_lattice(bounds, hull_check_cells);
    ShapeField hull_field(fine, hull.distance(fine.vertices()) / fine.cell);
    shape.hull_overlap = mask_overlap(marched(hull_field), views);

    Progress progress("shape", options.iterations);
    const auto levels = static_cast<int>(options.cells.size());
    const int coarse = options.iterations / (levels + 1);
    int done = 0;
    for (int level = 0; level < levels; ++level) {
        if (level > 0) {
            const torch::NoGradGuard no_gradient;
            const torch::Tensor start = 2 * refined_values(field->values, lattice);
            lattice = lattice.refined();
            field = std::make_unique<ShapeField>(lattice, start);
        }
        const int count = level + 1 < levels ? coarse : options.iterations - done;
        optimize_on_lattice(*field, appearance, views, options, done, count, shape, progress);
        done += count;
    }
    shape.mesh = simplified(without_specks(marched(*field)), options.triangles);
    return shape;
}

}  // namespace item3d
