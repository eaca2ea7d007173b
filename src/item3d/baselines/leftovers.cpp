#include "item3d/baselines/leftovers.h"

namespace item3d {
namespace {

at::Tensor mean_of_known(const at::Tensor& colors, const at::Tensor& known) {
    const at::Tensor weight = known.to(colors.scalar_type()).unsqueeze(1);
    return (colors * weight).sum(0, true) / weight.sum();
}

}  // namespace

at::Tensor fill_with_mean(const at::Tensor& colors, const at::Tensor& known) {
    if (!known.any().item<bool>()) return colors;
    return at::where(known.unsqueeze(1), colors, mean_of_known(colors, known));
}

at::Tensor fill_from_neighbours(const TexelList& texels, const at::Tensor& colors,
                                const at::Tensor& known) {
    const bool any = known.any().item<bool>();
    if (!any || known.all().item<bool>()) return colors;
    const at::Tensor ones = at::ones({colors.size(0), 1}, colors.options());
    const at::Tensor spread = texels.spread(at::cat({colors, ones}, 1), known);
    const at::Tensor reached = spread.slice(1, colors.size(1)) > 0.5;
    const at::Tensor others =
        at::where(reached, spread.slice(1, 0, colors.size(1)), mean_of_known(colors, known));
    return at::where(known.unsqueeze(1), colors, others);
}

}  // namespace item3d
