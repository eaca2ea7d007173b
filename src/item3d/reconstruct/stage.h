// Base class of both optimisation stages of a reconstruction. It has single steps, previews and a
// state that can be resumed.
#pragma once

#include "item3d/core/random.h"
#include "item3d/field/adam.h"
#include "item3d/reconstruct/surface/appearance.h"
#include "item3d/reconstruct/surface/view_corrections.h"
#include "item3d/reconstruct/surface/view_render.h"
#include "item3d/tensors/checkpoint.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

struct RefineCurves {
    std::vector<double> image, mask;
};

/// Optimisation state that every stage has.
struct Learning {
    Adam optimizer;
    Random random{0};
    RefineCurves curves;
    int iteration = 0;  ///< number of finished iterations
    /// Prefiltered light. It carries gradients only in some iterations, because prefiltering costs
    /// as much as rendering a view.
    EnvironmentLight light;
    /// Value for ViewRenderOptions::base_color_factor. Through it the loss has a gradient with
    /// respect to the light's scale. Undefined while the light is fixed.
    at::Tensor base_color_factor;

    /// Updates the prefiltered light. Returns true if the light is optimised in this iteration,
    /// that is, if `index` is a multiple of `every`. The result depends on the light and `index`
    /// alone.
    bool update_light(Appearance& appearance, int index, int every);
    void note_losses(const at::Tensor& image, const at::Tensor& mask);
};

/// Random order of the views, shuffled anew after each pass. It depends on the seed and the
/// iteration alone.
class ViewOrder {
  public:
    ViewOrder(std::size_t views, std::uint64_t seed) : order_(views), seed_(seed) {}

    std::size_t at(std::int64_t iteration) {
        const auto count = static_cast<std::int64_t>(order_.size());
        const std::int64_t round = iteration / count;
        if (round != round_) shuffle(round);
        return order_[static_cast<std::size_t>(iteration % count)];
    }

  private:
    void shuffle(std::int64_t round);

    std::vector<std::size_t> order_;
    std::uint64_t seed_;
    std::int64_t round_ = -1;
};

class Stage {
  public:
    Stage(Appearance& appearance, ViewCorrections& corrections)
        : appearance_(appearance), corrections_(corrections) {}
    virtual ~Stage() = default;
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

    virtual std::string name() const = 0;
    virtual int iterations() const = 0;
    int iteration() const { return learning_.iteration; }
    bool is_done() const { return iteration() >= iterations(); }

    /// Runs one iteration, on one image. If it throws Interrupted, the state is unchanged.
    virtual void step() = 0;
    /// Returns text for the progress line.
    virtual std::string detail() const = 0;
    /// Renders the current surface in the current light, without gradients.
    virtual RenderedView draw(const TargetView& view) = 0;

    /// Returns everything, including the appearance, that a resumed run needs to write the same
    /// bytes as an uninterrupted run.
    virtual NamedTensors state() const;
    /// Restores state() of a stage with the same settings. Throws InputError for missing tensors.
    virtual void load_state(const CheckpointReader& reader);

  protected:
    Appearance& appearance_;
    ViewCorrections& corrections_;
    Learning learning_;
};

/// Converts a curve to a tensor. curve_values() is the inverse.
at::Tensor curve_tensor(const std::vector<double>& values);
std::vector<double> curve_values(const at::Tensor& tensor);

}  // namespace item3d
