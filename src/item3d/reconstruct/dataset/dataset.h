// Photographs of one object with known cameras, prepared for comparison with renders.
#pragma once

#include "item3d/reconstruct/dataset/source.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/image.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Photograph as an ideal pinhole camera would have taken it.
struct Photograph {
    std::string name;
    /// Camera in a world with +Y up and the dataset's unit of length. Its near and far planes are
    /// not set.
    Camera camera;
    /// Premultiplied linear RGB and the object's coverage, as the renderer outputs them. Row 0 is
    /// the top row.
    Image image;
    /// Exposure from EXIF, up to a factor that all photographs share; 0 if unknown.
    double exposure = 0;
    std::filesystem::path file = {};  ///< file that the image was read from
};

struct Dataset {
    DatasetKind kind = DatasetKind::nerf_synthetic;
    std::vector<Photograph> train;
    std::vector<Photograph> test;  ///< held out: not used by the optimisation
    /// Rotation from the dataset's own world to that of the views.
    Mat3 world_from_dataset{1.0f};
    std::string masks;  ///< source of the masks, in words
    Vec3 centre{0.0f};  ///< least-squares nearest point to the cameras' optical axes
    /// Radius of the sphere around `centre` that half of the images show completely, see
    /// region_seen().
    float radius = 0.0f;
    std::size_t cut_off = 0;  ///< number of views in which the object touches the image's edge
};

struct DatasetOptions {
    std::filesystem::path images;        ///< folder of the images; if empty, the layout decides
    std::filesystem::path masks;         ///< folder of masks named like the images; may be empty
    std::optional<Vec3> background;      ///< sRGB; pixels of this colour are background
    float background_tolerance = 0.06f;  ///< maximum difference from the background per channel
    int longest_side = 0;    ///< images are downscaled to this length; 0 keeps their size
    bool is_linear = false;  ///< true if PNG and JPEG files hold linear light
    int hold_out = 8;   ///< if the layout has no split, every n-th view is a test view; 0 for none
    int max_views = 0;  ///< maximum number of training views, evenly chosen; 0 for all
    std::string up = "auto";  ///< "x", "y", "z", "-y"...: up axis in the dataset's world
};

/// Detects the layout of `path` (a folder, or a transforms.json), reads the dataset and checks it.
/// Each pose must have an image of its lens's size, masks must not be empty or full, and at least
/// three cameras must be at different positions. The mask of an image comes from the first of these
/// sources that exists: `options.masks`, mask_path in the file of poses, the folder "masks", the
/// image's alpha, `options.background`, a plain background. Throws InputError with a message of one
/// line.
Dataset load_dataset(const std::filesystem::path& path, const DatasetOptions& options = {});

/// Returns up to `count` of the views, evenly chosen.
std::vector<Photograph> some_views(const std::vector<Photograph>& views, std::size_t count);

}  // namespace item3d
