// Direction adjustment by captions (ITEM3D, section 3.4), and the record of how an edit went.
#pragma once

#include "item3d/edit/edit.h"
#include "item3d/edit/optimize/adjustment_record.h"
#include "item3d/edit/scene.h"
#include "item3d/guidance/caption_source.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct EditState;

/// Part of a checkpoint; what it did to the source is in the guidance's own state.
struct AdjustmentState {
    std::vector<AdjustmentRecord> records;
    std::vector<Caption> captions_before;  ///< of the unedited model, one for each view
    std::string failure;                   ///< why the captioner is not asked any more
};

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
    std::vector<Caption> follow(EditState& state, const at::Tensor& pictures) const;
    void give_up(AdjustmentState& state, const std::string& reason) const;

    const EditSettings& settings_;
    const EditScene& scene_;
    std::vector<Camera> cameras_;
    std::optional<CaptionSource> source_;
};

}  // namespace item3d
