// Direction adjustment by captions (ITEM3D, section 3.4), and the record of how an edit goes.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/guidance/caption_source.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Every adjust_every iterations: pictures of the field as it is, for the record and, where the
/// settings say so, for a captioner whose words move the source.
class DirectionAdjustment {
  public:
    /// request and scene must outlive this.
    DirectionAdjustment(const EditRequest& request, const EditScene& scene);

    /// Call before each iteration. A captioner that fails is not asked again: a warning, and the
    /// edit goes on with the source as it was. Throws Interrupted.
    void before_iteration(EditState& state) const;
    /// Call behind the last one: records how the edit ended.
    void finish(EditState& state) const;

  private:
    void observe(EditState& state) const;
    /// What the captioner's words move the source by; none where it is given up.
    std::optional<TextEmbedding> follow(EditState& state, const at::Tensor& pictures,
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
