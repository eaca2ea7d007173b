#include "item3d/reconstruct/surface/view_corrections.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

constexpr double rotation_rate = 0.0005;    ///< radians
constexpr double translation_rate = 0.001;  ///< rate in units of the radius
constexpr double motion_weight = 0.2;
constexpr float step_taken = 0.5f;    ///< fraction of pose_step()
constexpr double unsure_gain = 0.03;  ///< natural logarithm
constexpr double spread_weight = 2.0;
/// Sharpness, relative to images from about the same side, below which an image has less weight
/// (docs/reconstruct.md, "Poses, exposure, blur").
constexpr double sharp_enough = 0.58;
constexpr float same_side = 0.7f;  ///< cosine of the angle between directions
constexpr int fewest_pixels_across = 96;
constexpr double min_weight = 0.05;
constexpr std::size_t fewest_compared = 4, sides_compared = 6;
constexpr std::int64_t fewest_pixels = 64;  ///< minimum for an estimate of a gain

at::Tensor mean_of(const std::vector<at::Tensor>& all) {
    const at::NoGradGuard no_gradient;
    return at::stack(all).mean(0);
}

/// Returns logarithms [N, 3] of gains, which are EXIF's exposures divided by their median. They are
/// 0 unless all exposures are known.
at::Tensor gains_of_exif(const std::vector<Photograph>& views) {
    std::vector<double> logarithms;
    for (const Photograph& view : views)
        if (view.exposure > 0) logarithms.push_back(std::log(view.exposure));
    const auto count = static_cast<std::int64_t>(views.size());
    if (logarithms.size() < views.size()) return at::zeros({count, 3});
    const at::Tensor gains = at::tensor(logarithms).to(at::kFloat);
    return (gains - gains.median()).unsqueeze(1).repeat({1, 3});
}

std::vector<at::Tensor> zeros_for(std::size_t views) {
    std::vector<at::Tensor> result;
    for (std::size_t i = 0; i < views; ++i)
        result.push_back(at::zeros({3}).set_requires_grad(true));
    return result;
}

/// Returns the mean absolute Laplacian of log luminance over pixels whose neighbours are covered; 0
/// if there are no such pixels.
double mean_laplacian(const Image& image) {
    const auto value = [&](int x, int y) {
        return std::log(0.02f + 0.2126f * image.at(x, y, 0) + 0.7152f * image.at(x, y, 1) +
                        0.0722f * image.at(x, y, 2));
    };
    constexpr int margin = 3;
    double sum = 0, count = 0;
    for (int y = margin; y + margin < image.height; ++y) {
        for (int x = margin; x + margin < image.width; ++x) {
            const auto covered = [&](int dx, int dy) {
                return image.at(x + dx, y + dy, 3) > 0.99f;
            };
            if (!covered(-margin, 0) || !covered(margin, 0) || !covered(0, -margin) ||
                !covered(0, margin))
                continue;
            sum += std::abs(value(x - 1, y) + value(x + 1, y) + value(x, y - 1) + value(x, y + 1) -
                            4 * value(x, y));
            ++count;
        }
    }
    return count > 0 ? sum / count : 0;
}

}  // namespace

const char* pose_refinement_name(PoseRefinement refinement) {
    return refinement == PoseRefinement::automatic ? "auto"
           : refinement == PoseRefinement::refine  ? "refine"
                                                   : "keep";
}

ViewCorrections::ViewCorrections(const std::vector<Photograph>& views, Vec3 centre, float radius,
                                 const CorrectionOptions& options)
    : rotations_(zeros_for(views.size())),
      translations_(zeros_for(views.size())),
      exif_gains_(gains_of_exif(views)),
      log_gains_(exif_gains_.clone()),
      gain_spread_(at::zeros_like(log_gains_)),
      centre_(at::tensor({centre.x, centre.y, centre.z})),
      radius_(radius),
      options_(options),
      refines_poses_(options.poses == PoseRefinement::refine) {
    for (const double sharpness : relative_sharpness(views, centre))
        weights_.push_back(std::clamp(std::pow(sharpness / sharp_enough, 2), min_weight, 1.0));
}

void ViewCorrections::add_groups(Adam& adam) const {
    if (!refines_poses_) return;
    adam.add_group("rotations", rotations_, {.beta2 = 0.999});
    adam.add_group("translations", translations_, {.beta2 = 0.999});
    set_rates(adam, 1);
}

void ViewCorrections::set_rates(Adam& adam, double scale) const {
    if (!refines_poses_) return;
    adam.options("rotations").learning_rate = scale * rotation_rate;
    adam.options("translations").learning_rate = scale * translation_rate;
}

RigidMotion ViewCorrections::motion(std::size_t view) const {
    if (!refines_poses_) return {};
    return rigid_motion(
        {rotations_[view] - mean_of(rotations_), translations_[view] - mean_of(translations_)},
        centre_, radius_);
}

at::Tensor ViewCorrections::motion_loss(std::size_t view) const {
    if (!refines_poses_) return at::zeros({});
    return motion_weight * (rotations_[view].square().sum() + translations_[view].square().sum());
}

void ViewCorrections::update_motion(std::size_t view, const DrawnView& seen,
                                    const at::Tensor& photograph) {
    if (!refines_poses_) return;
    const at::NoGradGuard no_gradient;
    const RigidMotion now = motion(view);
    DrawnView drawn = seen;
    drawn.position = now.moved(seen.position);
    const SmallMotion step = pose_step(drawn, photograph, centre_, radius_);
    rotations_[view] += step_taken * step.rotation;
    translations_[view] += step_taken * step.translation;
}

at::Tensor ViewCorrections::gain(std::size_t view) const {
    if (!options_.exposure) return {};
    return gains()[static_cast<std::int64_t>(view)];
}

void ViewCorrections::update_gain(std::size_t view, const at::Tensor& drawn,
                                  const at::Tensor& photograph) {
    if (!options_.exposure) return;
    const at::NoGradGuard no_gradient;
    const auto index = static_cast<std::int64_t>(view);
    for (std::int64_t c = 0; c < 3; ++c) {
        const at::Tensor a = drawn.select(3, c), b = photograph.select(3, c);
        const at::Tensor used = (photograph.select(3, 3) > 0.99f)
                                    .logical_and(drawn.select(3, 3) > 0.99f)
                                    .logical_and(b < 0.98f)
                                    .logical_and(b > 0.01f)
                                    .logical_and(a > 0.005f);
        if (used.sum().item<std::int64_t>() < fewest_pixels) continue;
        const at::Tensor quotients = (b.masked_select(used) / a.masked_select(used)).log();
        const at::Tensor found = quotients.median();
        const at::Tensor spread = (quotients - found).abs().median();
        log_gains_[index][c] += 0.5 * (found - log_gains_[index][c]);
        gain_spread_[index][c] += 0.5 * (spread - gain_spread_[index][c]);
    }
}

Camera ViewCorrections::corrected_camera(const Camera& camera, std::size_t view) const {
    const at::NoGradGuard no_gradient;
    return refines_poses_ ? motion(view).seen_from(camera) : camera;
}

std::vector<Photograph> ViewCorrections::corrected(std::vector<Photograph> photographs) const {
    const at::Tensor all = gains().reciprocal().contiguous();
    const float* factor = all.const_data_ptr<float>();
    for (std::size_t i = 0; i < photographs.size(); ++i) {
        photographs[i].camera = corrected_camera(photographs[i].camera, i);
        std::vector<float>& pixels = photographs[i].image.pixels;
        for (std::size_t k = 0; options_.exposure && k < pixels.size(); ++k)
            if (k % 4 < 3) pixels[k] *= factor[3 * i + k % 4];
    }
    return photographs;
}

double ViewCorrections::largest_turn() const {
    const at::NoGradGuard no_gradient;
    const at::Tensor all = at::stack(rotations_);
    return (all - all.mean(0)).norm(2, 1).max().item<double>() * 180 / pi;
}

double ViewCorrections::largest_shift() const {
    const at::NoGradGuard no_gradient;
    const at::Tensor all = at::stack(translations_);
    return (all - all.mean(0)).norm(2, 1).max().item<double>();
}

at::Tensor ViewCorrections::gains() const {
    const at::NoGradGuard no_gradient;
    if (!options_.exposure) return at::ones_like(log_gains_);
    at::Tensor beside = log_gains_ - exif_gains_;
    beside = beside - std::get<0>(beside.median(0));
    // All pixels of an image share its exposure. So quotients that vary within an image come from
    // errors of the model.
    const at::Tensor square = beside.square();
    beside = beside * square / (square + (spread_weight * gain_spread_).square()).clamp_min(1e-12f);
    at::Tensor apart = exif_gains_ + beside;
    apart = apart - std::get<0>(apart.median(0));
    // If most gains are close to 1, exposure did not change. A few larger gains come from effects
    // such as a highlight in a single view.
    if (apart.abs().median().item<double>() < unsure_gain) return at::ones_like(log_gains_);
    return apart.exp();
}

std::vector<std::size_t> ViewCorrections::blurred() const {
    std::vector<std::size_t> views;
    for (std::size_t i = 0; i < weights_.size(); ++i)
        if (weights_[i] < 1) views.push_back(i);
    return views;
}

NamedTensors ViewCorrections::state() const {
    const at::NoGradGuard no_gradient;
    return {{"correction.rotations", at::stack(rotations_)},
            {"correction.translations", at::stack(translations_)},
            {"correction.log_gains", log_gains_.clone()},
            {"correction.gain_spread", gain_spread_.clone()}};
}

void ViewCorrections::load_state(const CheckpointReader& reader) {
    const at::NoGradGuard no_gradient;
    const auto load = [&](const char* name, std::vector<at::Tensor>& into) {
        at::Tensor all = at::stack(into).contiguous();
        reader.copy(name, all);
        for (std::size_t i = 0; i < into.size(); ++i)
            into[i].copy_(all[static_cast<std::int64_t>(i)]);
    };
    load("correction.rotations", rotations_);
    load("correction.translations", translations_);
    reader.copy("correction.log_gains", log_gains_);
    reader.copy("correction.gain_spread", gain_spread_);
}

std::vector<double> relative_sharpness(const std::vector<Photograph>& views, Vec3 centre) {
    std::vector<double> sharpness;
    std::vector<Vec3> directions;
    for (const Photograph& view : views) {
        sharpness.push_back(mean_laplacian(view.image));
        directions.push_back(glm::normalize(view.camera.position() - centre));
    }
    std::vector<double> relative;
    for (std::size_t i = 0; i < views.size(); ++i) {
        std::vector<std::pair<float, double>> beside;
        for (std::size_t k = 0; k < views.size(); ++k) {
            const float cosine = glm::dot(directions[i], directions[k]);
            if (cosine > same_side) beside.emplace_back(-cosine, sharpness[k]);
        }
        if (beside.size() < fewest_compared || views[i].image.width < fewest_pixels_across) {
            relative.push_back(1);
            continue;
        }
        std::sort(beside.begin(), beside.end());
        beside.resize(std::min(beside.size(), sides_compared + 1));
        std::sort(beside.begin(), beside.end(),
                  [](const auto& a, const auto& b) { return a.second < b.second; });
        const double median = beside[beside.size() / 2].second;
        relative.push_back(median > 0 ? sharpness[i] / median : 1.0);
    }
    return relative;
}

}  // namespace item3d
