// What photographs differ in besides what they show: a pose that is a little off, exposure and
// white balance, blur. Found together with materials and light.
#pragma once

#include "item3d/field/adam.h"
#include "item3d/reconstruct/dataset/dataset.h"
#include "item3d/reconstruct/surface/pose_step.h"
#include "item3d/reconstruct/surface/rigid_motion.h"
#include "item3d/tensors/checkpoint.h"
#include "item3d/tensors/tensor.h"

#include <cstddef>
#include <vector>

namespace item3d {

/// Whether cameras are moved. automatic: where their outlines do not agree (align_to_hull()).
enum class PoseRefinement { automatic, refine, keep };
/// "auto", "refine", "keep".
const char* pose_refinement_name(PoseRefinement refinement);

struct CorrectionOptions {
    PoseRefinement poses = PoseRefinement::automatic;
    bool exposure = true;  ///< a gain for each view and channel
};

/// Gain and motion of each training view. The median of the gains is 1 and the mean of the motions
/// none, because a brighter light and a moved object would explain either as well. Gains begin as
/// the exposures of EXIF are, where all pictures have them.
class ViewCorrections {
  public:
    ViewCorrections(const std::vector<Photograph>& views, Vec3 centre, float radius,
                    const CorrectionOptions& options);

    const CorrectionOptions& options() const { return options_; }
    /// What `automatic` came to. Until it is said, poses are kept.
    void decide(bool refines_poses) { refines_poses_ = refines_poses; }
    bool refines_poses() const { return refines_poses_; }
    void add_groups(Adam& adam) const;
    /// scale: of the learning rates that add_groups() begins with.
    void set_rates(Adam& adam, double scale) const;

    /// Undefined tensors where poses are kept.
    RigidMotion motion(std::size_t view) const;
    /// Moves the view's camera half of the way to its photograph (pose_step()). seen: drawn with
    /// motion(view), its positions moved back (RigidMotion::move_back()).
    void update_motion(std::size_t view, const DrawnView& seen, const at::Tensor& photograph);
    /// Square of the motion, so that what no picture shows stays as it was; 0 where poses are kept.
    at::Tensor motion_loss(std::size_t view) const;
    /// [3], what radiance is multiplied by; undefined where exposure is kept. All are 1 where half
    /// of them are within 3 % of it, and each is nearer to EXIF's the more the picture's quotients
    /// differ among themselves: gains may not explain what materials can.
    at::Tensor gain(std::size_t view) const;
    /// Moves the view's gain half the way to the one that brings what was drawn without any to the
    /// photograph: the median of their quotients. [1, H, W, 4] each, as TargetView's.
    void update_gain(std::size_t view, const at::Tensor& drawn, const at::Tensor& photograph);
    /// Of the picture's loss, in (0, 1]: below 1 where the view is less sharp than those around it.
    double weight(std::size_t view) const { return weights_[view]; }

    Camera corrected_camera(const Camera& camera, std::size_t view) const;
    /// Photographs as they would be with the cameras and the exposures that were found.
    std::vector<Photograph> corrected(std::vector<Photograph> photographs) const;
    /// For reports: the largest angle in degrees and the largest shift as a part of the radius.
    double largest_turn() const;
    double largest_shift() const;
    /// Gains of all views, [N, 3].
    at::Tensor gains() const;
    /// Views that count less.
    std::vector<std::size_t> blurred() const;

    NamedTensors state() const;
    void load_state(const CheckpointReader& reader);

  private:
    std::vector<at::Tensor> rotations_;     ///< [3] each, axis times angle
    std::vector<at::Tensor> translations_;  ///< [3] each, of the radius
    at::Tensor exif_gains_;                 ///< [N, 3], logarithms
    at::Tensor log_gains_;                  ///< [N, 3], medians of quotients
    at::Tensor gain_spread_;                ///< [N, 3], how far quotients are from these
    std::vector<double> weights_;
    at::Tensor centre_;
    float radius_;
    CorrectionOptions options_;
    bool refines_poses_;
};

/// How sharp each picture is: the mean size of the Laplacian of its log luminance well inside the
/// mask, divided by the median of itself and of up to six views from the nearest directions. 1
/// where fewer than four look from within 45 degrees, or where a picture is less than 96 pixels
/// wide.
std::vector<double> relative_sharpness(const std::vector<Photograph>& views, Vec3 centre);

}  // namespace item3d
