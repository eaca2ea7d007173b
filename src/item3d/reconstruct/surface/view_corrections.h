// Corrections of each photograph: pose, exposure and white balance, and a weight against blur.
// Optimised together with materials and light.
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

/// Choice of pose refinement. automatic: if the outlines are inconsistent (align_to_hull()).
enum class PoseRefinement { automatic, refine, keep };
/// Returns "auto", "refine" or "keep".
const char* pose_refinement_name(PoseRefinement refinement);

struct CorrectionOptions {
    PoseRefinement poses = PoseRefinement::automatic;
    bool exposure = true;  ///< a gain per view and channel
};

/// Gain and motion of each training view. The median of the gains is 1 and the mean of the motions
/// zero, because a brighter light or a moved object would explain either as well. Gains start from
/// the EXIF exposures if all images have them.
class ViewCorrections {
  public:
    ViewCorrections(const std::vector<Photograph>& views, Vec3 centre, float radius,
                    const CorrectionOptions& options);

    const CorrectionOptions& options() const { return options_; }
    /// Resolves `automatic`. Until then poses are kept.
    void decide(bool refines_poses) { refines_poses_ = refines_poses; }
    bool refines_poses() const { return refines_poses_; }
    void add_groups(Adam& adam) const;
    /// Sets the learning rates to `scale` times those of add_groups().
    void set_rates(Adam& adam, double scale) const;

    /// Returns the view's motion; undefined tensors if poses are kept.
    RigidMotion motion(std::size_t view) const;
    /// Moves the view's camera half of the way to its photograph (pose_step()). seen: drawn with
    /// motion(view), its positions moved back (RigidMotion::move_back()).
    void update_motion(std::size_t view, const DrawnView& seen, const at::Tensor& photograph);
    /// Returns the square of the motion, which keeps undetermined poses in place; 0 if poses are
    /// kept.
    at::Tensor motion_loss(std::size_t view) const;
    /// Returns the view's factor of radiance, [3]; undefined if exposure is kept. All gains are 1
    /// if half of them are within 3 % of it, and each is nearer to EXIF's the more the image's
    /// quotients vary: gains must not explain effects of materials.
    at::Tensor gain(std::size_t view) const;
    /// Moves the view's gain half of the way to the one that aligns the render without gain with
    /// the photograph: the median of their quotients. [1, H, W, 4] each, as in TargetView.
    void update_gain(std::size_t view, const at::Tensor& drawn, const at::Tensor& photograph);
    /// Weight of the image's loss, in (0, 1]: below 1 if the view is less sharp than those around
    /// it.
    double weight(std::size_t view) const { return weights_[view]; }

    Camera corrected_camera(const Camera& camera, std::size_t view) const;
    /// Returns the photographs with the cameras and the exposures that were found.
    std::vector<Photograph> corrected(std::vector<Photograph> photographs) const;
    /// For reports: the largest angle in degrees and the largest shift as a fraction of the radius.
    double largest_turn() const;
    double largest_shift() const;
    /// Returns the gains of all views, [N, 3].
    at::Tensor gains() const;
    /// Returns the views of weight below 1.
    std::vector<std::size_t> blurred() const;

    NamedTensors state() const;
    void load_state(const CheckpointReader& reader);

  private:
    std::vector<at::Tensor> rotations_;     ///< [3] each, axis times angle
    std::vector<at::Tensor> translations_;  ///< [3] each, in units of the radius
    at::Tensor exif_gains_;                 ///< [N, 3], logarithms
    at::Tensor log_gains_;                  ///< [N, 3], medians of quotients
    at::Tensor gain_spread_;                ///< [N, 3], deviation of the quotients from these
    std::vector<double> weights_;
    at::Tensor centre_;
    float radius_;
    CorrectionOptions options_;
    bool refines_poses_;
};

/// Returns the sharpness of each image: the mean size of the Laplacian of its log luminance well
/// inside the mask, divided by the median over itself and up to six views from the nearest
/// directions. 1 if fewer than four look from within 45 degrees, or if an image is less than 96
/// pixels wide.
std::vector<double> relative_sharpness(const std::vector<Photograph>& views, Vec3 centre);

}  // namespace item3d
