// Corrections of each photograph: pose, exposure, white balance, and a lower weight for blurred
// images. They are optimised together with materials and light.
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

/// Choice of pose refinement. With `automatic`, poses are refined if the outlines are inconsistent
/// (see align_to_hull()).
enum class PoseRefinement { automatic, refine, keep };
/// Returns "auto", "refine" or "keep".
const char* pose_refinement_name(PoseRefinement refinement);

struct CorrectionOptions {
    PoseRefinement poses = PoseRefinement::automatic;
    bool exposure = true;  ///< true if each view and channel gets a gain
};

/// Gain and motion of each training view. The median of the gains is 1, because a brighter light
/// would explain a common gain as well. The mean of the motions is zero, because a moved object
/// would explain a common motion as well. Gains start from the EXIF exposures if all images have
/// them.
class ViewCorrections {
  public:
    ViewCorrections(const std::vector<Photograph>& views, Vec3 centre, float radius,
                    const CorrectionOptions& options);

    const CorrectionOptions& options() const { return options_; }
    /// Sets whether poses are refined under PoseRefinement::automatic. Before this call, poses are
    /// kept.
    void decide(bool refines_poses) { refines_poses_ = refines_poses; }
    bool refines_poses() const { return refines_poses_; }
    void add_groups(Adam& adam) const;
    /// Sets the learning rates to `scale` times those of add_groups().
    void set_rates(Adam& adam, double scale) const;

    /// Returns the view's motion. Its tensors are undefined if poses are kept.
    RigidMotion motion(std::size_t view) const;
    /// Moves the view's camera by half of the step that pose_step() returns. seen: render of the
    /// object moved by motion(view), whose positions RigidMotion::move_back() moved back.
    void update_motion(std::size_t view, const DrawnView& seen, const at::Tensor& photograph);
    /// Returns a loss proportional to the square of the view's motion. It keeps a pose in place if
    /// the image does not determine the pose. The loss is 0 if poses are kept.
    at::Tensor motion_loss(std::size_t view) const;
    /// Returns the factor [3] of the view's radiance; undefined if exposure is not corrected. All
    /// gains are 1 if half of them are within 3 % of 1. The more the quotients of update_gain()
    /// vary over an image, the closer its gain is to the one from EXIF. Both rules keep gains from
    /// explaining effects of materials.
    at::Tensor gain(std::size_t view) const;
    /// Moves the view's gain half of the way to the median of the quotients of photograph and
    /// render at the pixels. drawn: render without gain. Both images are [1, H, W, 4] as in
    /// TargetView.
    void update_gain(std::size_t view, const at::Tensor& drawn, const at::Tensor& photograph);
    /// Returns the weight of the image's loss, in (0, 1]. It is below 1 if the image is less sharp
    /// than images from similar directions.
    double weight(std::size_t view) const { return weights_[view]; }

    Camera corrected_camera(const Camera& camera, std::size_t view) const;
    /// Returns the photographs with corrected cameras and exposures.
    std::vector<Photograph> corrected(std::vector<Photograph> photographs) const;
    /// The next two functions serve reports. They return the largest rotation of a view in degrees,
    /// and the largest translation as a fraction of the radius.
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
    at::Tensor log_gains_;                  ///< [N, 3], logarithms: medians of quotients
    at::Tensor gain_spread_;                ///< [N, 3], deviation of the quotients from log_gains_
    std::vector<double> weights_;
    at::Tensor centre_;
    float radius_;
    CorrectionOptions options_;
    bool refines_poses_;
};

/// Returns the relative sharpness of each image. An image's sharpness is the mean absolute
/// Laplacian of its log luminance well inside the mask. It is divided by the median sharpness of
/// this image and up to six others from the nearest directions within 45 degrees. The result is 1
/// if these are fewer than four images in all, or if the image is less than 96 pixels wide.
std::vector<double> relative_sharpness(const std::vector<Photograph>& views, Vec3 centre);

}  // namespace item3d
