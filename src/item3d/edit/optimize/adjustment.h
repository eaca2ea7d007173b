// The adjustment of the direction by captions (ITEM3D, section 3.4), and the record of an edit's
// course.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/guidance/caption_source.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Renders the neural texture every adjust_every iterations, for the record. If the settings ask
/// for a captioner, the captioner describes the renders, and its captions shift the embedding of
/// the source sentence.
class DirectionAdjustment {
  public:
    /// request and scene must outlive this object.
    DirectionAdjustment(const EditRequest& request, const EditScene& scene);

    /// Must be called before each iteration. If the captioner fails, warns and does not call it
    /// again; the edit continues without further shifts of the source. Throws Interrupted.
    void before_iteration(EditState& state) const;
    /// Records the end of the edit. Must be called after the last iteration.
    void finish(EditState& state) const;

  private:
    void observe(EditState& state) const;
    /// Returns the shift of the source embedding that follows from the captions. Returns no value
    /// if the captioner has failed.
    std::optional<TextEmbedding> follow(EditState& state, const at::Tensor& images,
                                        std::vector<std::string>& said) const;
    std::optional<TextEmbedding> handed_on(const std::optional<TextEmbedding>& shift) const;
    void give_up(AdjustmentState& state, const std::string& reason) const;

    const EditPlan& plan_;
    const EditScene& scene_;
    const ProcessGroup& processes_;
    std::vector<Camera> cameras_;
    std::optional<CaptionSource> source_;
};

}  // namespace item3d
